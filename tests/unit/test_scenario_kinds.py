"""Kinds of scenarios: the laws of sizes and strengths, and two-way coupling."""

import json

import pytest

import rubnoise
from rubnoise.contact.births import BIRTHS
from rubnoise.contact.distributions import Fixed, Gamma, Law, Lognormal, Normal, Power, Weibull
from rubnoise.contact.laws import Spread, law_for
from rubnoise.scenario import build, loads
from tests.unit.scenarios import BARE, WHOLE, refusal, whole

# The laws of sizes and strengths in a scenario: what each takes, what it becomes, and how wide it may be.
SPREADING = {"normal": Normal, "lognormal": Lognormal, "gamma": Gamma}
STRENGTH = '[strength]\nmean = "250 MPa"\n'


def strong(law: str, spread: str) -> str:
    """Return the whole scenario with a law of strengths and its spread, left out where it is nothing."""
    spread = f"spread = {spread}\n" if spread else ""
    return WHOLE.replace(STRENGTH, f'{STRENGTH}law = "{law}"\n{spread}')


@pytest.mark.parametrize("law", SPREADING)
@pytest.mark.parametrize(("spread", "absolute", "relative"), [('"0.2 um"', 0.2, 0.0), ('"20 %"', 0.0, 0.2)])
def test_a_size_law_has_the_calibrated_diameter_and_its_spread(
    law: str, spread: str, absolute: float, relative: float
) -> None:
    model = loads(whole(law=f'"{law}"', spread=spread)).model()
    diameter = model.calibrated_diameter
    assert model.sizes == law_for(diameter, Spread(absolute=absolute + relative * diameter, law=law))
    assert isinstance(model.sizes, SPREADING[law])


def test_exponential_sizes_need_no_spread() -> None:
    model = loads(BARE + '[diameter]\nlaw = "exponential"\n', overrides=["interface.calibration=exact"]).model()
    assert model.sizes == Weibull(mean=model.calibrated_diameter, std=model.calibrated_diameter)
    assert model.stationary_mean_area == pytest.approx(6.0 * 200.0, rel=1e-14)


@pytest.mark.parametrize(
    ("law", "spread", "expected"),
    [
        ("constant", "", Fixed(value=250.0)),
        ("normal", '"50 MPa"', Normal(centre=250.0, std=50.0)),
        ("lognormal", '"20 %"', Lognormal(mean=250.0, std=50.0)),
        ("weibull", '"0.1 GPa"', Weibull(mean=250.0, std=100.0)),
        ("weibull", '"0 %"', Fixed(value=250.0)),
    ],
)
def test_a_strength_law_has_its_mean_and_spread(law: str, spread: str, expected: Law) -> None:
    scenario = loads(strong(law, spread))
    assert scenario.model().strengths == expected
    assert build(scenario.resolved()).model().strengths == expected


@pytest.mark.parametrize("law", ["lognormal", "gamma"])
def test_a_long_tail_may_be_three_times_the_mean_and_no_more(law: str) -> None:
    loads(whole(law=f'"{law}"', spread='"300 %"'))
    loads(whole(spread='"301 %"'))


POWER = "exponent = 2.5\nsmallest = 0.5\nlargest = 4.0\n"


def powered(own: str = POWER, table: str = "diameter") -> str:
    """Return the whole scenario with power laws, which stand where a law has keys of its own."""
    if table == "strength":
        return WHOLE.replace(STRENGTH, f'{STRENGTH}law = "power"\n{own}')
    return whole(law='"power"').replace('spread = "0.2 um"\n', own)


def test_a_power_law_takes_keys_of_its_own_as_ratios_to_the_centre() -> None:
    scenario = loads(powered())
    model = scenario.model()
    d = model.calibrated_diameter
    assert model.sizes == Power(exponent=2.5, smallest=0.5 * d, largest=4.0 * d)
    assert build(scenario.resolved()).model().sizes == model.sizes
    assert loads(powered(table="strength")).model().strengths == Power(exponent=2.5, smallest=125.0, largest=1000.0)


# Two-way coupling in scenarios: its keys, what they leave out, and what is refused beside them.
TWO_WAY = WHOLE.replace('damping = "0.05 N*s/m"\n', 'damping = "0.05 N*s/m"\ncoupling = "two-way"\n')


def test_one_way_is_what_a_scenario_without_the_key_means_and_says_nothing_of_cells() -> None:
    scenario = loads(WHOLE)
    assert not scenario.model().is_two_way
    assert scenario.resolved()["slider"] == {
        "mass": "0.005 kg",
        "stiffness": "300 N/m",
        "damping": "0.05 N*s/m",
        "coupling": "one-way",
        "start": "equilibrium",
    }


def test_two_way_has_cells_and_is_the_same_when_read_again() -> None:
    scenario = loads(TWO_WAY)
    slider = scenario.model().slider
    assert slider is not None
    assert (slider.coupling, slider.cells) == ("two-way", 50)
    assert scenario.resolved()["slider"]["cells"] == 50
    again = build(json.loads(json.dumps(scenario.resolved())))
    assert again.model() == scenario.model()
    assert again.resolved() == scenario.resolved()


@pytest.mark.parametrize("law", BIRTHS)
def test_a_law_of_births_takes_its_own_keys_and_no_others(law: str) -> None:
    keys = {each.name: each.sample for each in BIRTHS[law].parameters}
    table = "".join(f"{key} = {json.dumps(value)}\n" for key, value in keys.items())
    text = f'{BARE}[birth]\nlaw = "{law}"\n'
    model = loads(text + table).model()
    assert type(model.births).__name__.lower().startswith(law)
    assert build(loads(text + table).resolved()).model() == model
    for key, value in {each.name: each.sample for entry in BIRTHS.values() for each in entry.parameters}.items():
        if key in keys:
            assert f'birth.{key}: missing; the law "{law}" needs a {key}' in refusal(text)
        else:
            given = refusal(f"{text}{table}{key} = {json.dumps(value)}\n")
            assert f'birth.{key}: the law "{law}" takes no {key}' in given


CONTACT_OF_FIFTEEN = (
    'format = 1\n[interface]\nmean_junction_count = 15\n[diameter]\nmean = "5 um"\n[sliding]\ndistance = "2 mm"\n'
)


@pytest.mark.parametrize(
    "sizes",
    ["", 'law = "normal"\nspread = "60 %"\n', 'law = "normal"\nspread = "4 um"\n', 'law = "gamma"\nspread = "80 %"\n'],
    ids=["fixed", "redrawn", "absolute", "gamma"],
)
def test_fifteen_junctions_of_five_um_are_fifteen_and_five_and_their_area_follows(sizes: str) -> None:
    model = loads(CONTACT_OF_FIFTEEN.replace('mean = "5 um"\n', f'mean = "5 um"\n{sizes}')).model()
    assert model.sizes.moment(1) == pytest.approx(5.0, rel=1e-13)
    assert model.birth_rate * 2.0 * model.sizes.moment(1) == pytest.approx(15.0, rel=1e-13)
    one = model.sizes.moment(3) / (3.0 * model.sizes.moment(1))  # of a lens, found alive
    assert model.mean_real_contact_area == pytest.approx(15.0 * one, rel=1e-12)
    assert model.stationary_mean_area == pytest.approx(15.0 * one, rel=1e-12)


def test_beside_an_area_the_count_follows_and_the_scenario_reads_back() -> None:
    made = loads(CONTACT_OF_FIFTEEN.replace("mean_junction_count = 15", 'load = "0.2 N"\nhardness = "1 GPa"'))
    assert made.model().mean_junction_count == pytest.approx(24.0, rel=1e-14)
    assert "calibration" not in made.resolved()["interface"]
    assert loads(made.to_toml()).model() == made.model()


def test_the_later_of_a_mean_and_an_area_counts() -> None:
    made = rubnoise.load("first/rubbing", ["diameter.mean=5um"])
    assert (made.diameter.mean, made.interface.mean_real_contact_area) == (5.0, None)
    assert made.replace(speed="3 mm/s").diameter.mean == 5.0
    again = made.replace(mean_real_contact_area="100 um^2")
    assert (again.diameter.mean, again.interface.mean_real_contact_area) == (None, 100.0)
    assert again.replace({"diameter.mean": "4 um"}).interface.mean_real_contact_area is None
    loaded = rubnoise.load("load/fig5_load", ["diameter.mean=5um"])
    assert (loaded.interface.load, loaded.interface.mean_junction_count) == (200_000.0, None)
