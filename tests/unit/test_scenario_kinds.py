"""Kinds of scenarios: the laws of sizes and strengths, and two-way coupling."""

import json

import pytest

import rubnoise
from rubnoise.contact.births import BIRTHS
from rubnoise.contact.laws import Exponential, Fixed, Gamma, Law, Lognormal, Normal, Power, Spread, Weibull, law_for
from rubnoise.errors import ScenarioRefused
from rubnoise.scenario import build, loads
from tests.unit.scenarios import BARE, WHOLE, refusal, whole
from tests.unit.test_scenario_traps import shown

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
    assert model.sizes == Exponential(mean=model.calibrated_diameter)
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


@pytest.mark.parametrize("law", [*SPREADING, "strength normal", "strength lognormal", "strength weibull"])
def test_a_law_with_a_spread_needs_one(law: str) -> None:
    if law in SPREADING:
        report = refusal(whole(law=f'"{law}"').replace('spread = "0.2 um"\n', ""))
        head = f'run.toml:9: error: diameter.spread: missing; the law "{law}" needs a spread'
    else:
        report = refusal(strong(law.removeprefix("strength "), ""))
        head = f'run.toml:13: error: strength.spread: missing; the law "{law.split()[1]}" needs a spread'
    assert report.splitlines()[0] == head


@pytest.mark.parametrize("law", ['law = "constant"\n', ""])
def test_one_strength_takes_no_spread(law: str) -> None:
    report = refusal(WHOLE.replace(STRENGTH, f'{STRENGTH}{law}spread = "5 MPa"\n'))
    assert 'error: strength.spread: the law "constant" takes no spread' in report
    assert report.endswith('write law = "normal", or leave the spread out')


@pytest.mark.parametrize("law", ["lognormal", "gamma"])
def test_a_long_tail_may_be_three_times_the_mean_and_no_more(law: str) -> None:
    loads(whole(law=f'"{law}"', spread='"300 %"'))
    report = refusal(whole(law=f'"{law}"', spread='"301 %"'))
    head = f'run.toml:11: error: diameter.spread: 3.01 times the mean is too wide for the law "{law}"'
    assert (report.splitlines()[0], report.splitlines()[-1]) == (head, '    up to "300 %"')
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


@pytest.mark.parametrize("table", ["diameter", "strength"])
@pytest.mark.parametrize("key", ["exponent", "smallest", "largest"])
def test_a_law_needs_every_key_of_its_own(table: str, key: str) -> None:
    lines = [line for line in POWER.splitlines() if not line.startswith(key)]
    report = refusal(powered("\n".join(lines) + "\n", table))
    assert f'error: {table}.{key}: missing; the law "power" needs {"an" if key == "exponent" else "a"} {key}' in report


def test_keys_of_another_law_are_refused_with_the_law_that_takes_them() -> None:
    report = refusal(whole(law='"normal"').replace('spread = "0.2 um"\n', f'spread = "0.2 um"\n{POWER}'))
    assert report.splitlines()[0] == 'run.toml:12: error: diameter.exponent: the law "normal" takes no exponent'
    assert 'write law = "power", or leave the exponent out' in report
    assert 'diameter.spread: the law "power" takes no spread' in refusal(powered(f'{POWER}spread = "1 um"\n'))


@pytest.mark.parametrize("largest", ["0.5", "0.2"])
def test_the_ends_of_a_range_have_an_order(largest: str) -> None:
    report = refusal(powered(POWER.replace("4.0", largest)))
    assert report.splitlines()[0] == (
        "run.toml:13: error: diameter.largest: must be larger than diameter.smallest = 0.5"
    )


# Two-way coupling in scenarios: its keys, what they leave out, and what is refused beside them.
TWO_WAY = WHOLE.replace('damping = "0.05 N*s/m"\n', 'damping = "0.05 N*s/m"\ncoupling = "two-way"\n')
LINE = 1 + TWO_WAY[: TWO_WAY.index("coupling")].count("\n")


def with_tolerance(value: str, text: str = TWO_WAY) -> str:
    return text.replace("\n[output]", f"tolerance = {value}\n\n[output]").replace('"\n\ntolerance', '"\ntolerance')


def test_one_way_is_what_a_scenario_without_the_key_means_and_says_nothing_of_a_tolerance() -> None:
    scenario = loads(WHOLE)
    assert not scenario.model().is_two_way
    assert scenario.resolved()["slider"] == {
        "mass": "0.005 kg",
        "stiffness": "300 N/m",
        "damping": "0.05 N*s/m",
        "coupling": "one-way",
        "start": "equilibrium",
    }


def test_two_way_has_a_tolerance_and_is_the_same_when_read_again() -> None:
    scenario = loads(TWO_WAY)
    slider = scenario.model().slider
    assert slider is not None
    assert (slider.coupling, slider.tolerance) == ("two-way", 1e-9)
    assert scenario.resolved()["slider"]["tolerance"] == 1e-9
    again = build(json.loads(json.dumps(scenario.resolved())))
    assert again.model() == scenario.model()
    assert again.resolved() == scenario.resolved()


@pytest.mark.parametrize(
    ("value", "message", "hint"),
    [
        ("0.9e-12", "too small", "possible: 1e-12 to 0.0001"),
        ("1.1e-4", "too large", "possible: 1e-12 to 0.0001"),
        ("0.0", "must be above 0", "possible: 1e-12 to 0.0001"),
        ('"1e-9"', "needs a number, not a text", "write 1e-9 without quotation marks"),
    ],
)
def test_a_tolerance_out_of_range_is_refused(value: str, message: str, hint: str) -> None:
    head = f"run.toml:{LINE + 1}: error: slider.tolerance: {message}"
    assert refusal(with_tolerance(value)) == shown(head, f"tolerance = {value}", value, hint)


@pytest.mark.parametrize("law", BIRTHS)
def test_a_law_of_births_takes_its_own_keys_and_no_others(law: str) -> None:
    keys = {each.name: each.sample for each in BIRTHS[law].keys}
    table = "".join(f"{key} = {json.dumps(value)}\n" for key, value in keys.items())
    text = f'{BARE}[birth]\nlaw = "{law}"\n'
    model = loads(text + table).model()
    assert type(model.births).__name__.lower().startswith(law)
    assert build(loads(text + table).resolved()).model() == model
    for key, value in {each.name: each.sample for entry in BIRTHS.values() for each in entry.keys}.items():
        if key in keys:
            assert f'birth.{key}: missing; the law "{law}" needs a {key}' in refusal(text)
        else:
            given = refusal(f"{text}{table}{key} = {json.dumps(value)}\n")
            assert f'birth.{key}: the law "{law}" takes no {key}' in given


def test_clusters_wider_than_ten_thousand_spacings_are_refused() -> None:
    wide = f'{BARE}[birth]\nlaw = "clustered"\ncluster_size = 3\ncluster_width = "1 m"\n'
    assert "birth.cluster_width: 1e+06 um is 1.83e+06 mean spacings of births" in refusal(wide)


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


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("= 15\n", '= 15\nmean_real_contact_area = "200 um^2"\n', "keep two of the three"),
        ("mean_junction_count = 15", 'patch_area = "10 um^2"', "keep exactly one of the two"),
        ("= 15\n", '= 15\ncalibration = "exact"\n', "leave the calibration out"),
        ("mean_junction_count = 15", "", "missing"),
        ('mean = "5 um"', 'mean = "5 um"\nlaw = "empirical"\nvalues = [4.0, 5.0]', "mean of its own"),
        ('mean = "5 um"', 'mean = "5 um"\nspread = "5 kg"', "a length or a ratio is needed"),
        ('mean = "5 um"', 'mean = "5 um"\nlaw = "normal"\nspread = "10 um"', "wider than the mean diameter"),
    ],
)
def test_what_does_not_go_with_a_mean_diameter_is_refused(old: str, new: str, said: str) -> None:
    with pytest.raises(ScenarioRefused, match=said):
        loads(CONTACT_OF_FIFTEEN.replace(old, new))
