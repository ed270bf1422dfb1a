"""Kinds of scenarios: the laws of sizes and strengths, and two-way coupling."""

import json
from typing import Any

import numpy as np
import pytest

import rubnoise
from rubnoise.contact.births import BIRTHS
from rubnoise.contact.laws import Exponential, Fixed, Gamma, Law, Lognormal, Normal, Power, Spread, Weibull, law_for
from rubnoise.errors import Refused, ScenarioRefused
from rubnoise.scenario import build, loads
from rubnoise.scenario.sweep import load_sweep
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


@pytest.mark.parametrize("law", ["lognormal", "exponential", "gamma"])
def test_matched_sizes_have_the_mean_area_asked_for(law: str) -> None:
    spread = "" if law == "exponential" else 'spread = "150 %"\n'
    text = BARE.replace("[sliding]", f'calibration = "matched"\n[diameter]\nlaw = "{law}"\n{spread}[sliding]')
    assert loads(text).model().stationary_mean_area == pytest.approx(200.0, rel=1e-13)


@pytest.mark.parametrize("law", ["lognormal", "gamma"])
def test_no_spread_at_all_is_one_size(law: str) -> None:
    model = loads(whole(law=f'"{law}"', spread='"0 um"')).model()
    assert model.sizes == Fixed(value=model.calibrated_diameter)


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


def test_exponential_sizes_take_no_spread() -> None:
    report = refusal(whole(law='"exponential"')).splitlines()
    assert report[0] == 'run.toml:11: error: diameter.spread: the law "exponential" takes no spread'
    assert report[-1] == '    write law = "gamma", or leave the spread out'


@pytest.mark.parametrize("law", ['law = "constant"\n', ""])
def test_one_strength_takes_no_spread(law: str) -> None:
    report = refusal(WHOLE.replace(STRENGTH, f'{STRENGTH}{law}spread = "5 MPa"\n'))
    assert 'error: strength.spread: the law "constant" takes no spread' in report
    assert report.endswith('write law = "normal", or leave the spread out')


def test_a_strength_does_not_spread_over_a_length() -> None:
    report = refusal(strong("normal", '"5 um"'))
    assert report.startswith('run.toml:16: error: strength.spread: "um" is the unit of a length, a stress or a ratio')


@pytest.mark.parametrize("law", ["lognormal", "gamma"])
def test_a_long_tail_may_be_three_times_the_mean_and_no_more(law: str) -> None:
    loads(whole(law=f'"{law}"', spread='"300 %"'))
    report = refusal(whole(law=f'"{law}"', spread='"301 %"'))
    head = f'run.toml:11: error: diameter.spread: 3.01 times the mean is too wide for the law "{law}"'
    assert (report.splitlines()[0], report.splitlines()[-1]) == (head, '    up to "300 %"')
    loads(whole(spread='"301 %"'))


def test_strengths_may_be_as_wide_and_no_more() -> None:
    loads(strong("weibull", '"750 MPa"'))
    assert "strength.spread: 4 times the mean is too wide" in refusal(strong("weibull", '"1 GPa"'))
    loads(strong("normal", '"1 GPa"'))


def test_python_gives_spreads_in_working_units() -> None:
    values = {
        "format": 1,
        "interface": {"mean_real_contact_area": 200, "mean_junction_count": 20},
        "diameter": {"law": "gamma", "spread": 0.5},
        "strength": {"law": "weibull", "mean": 250, "spread": 40},
        "sliding": {"distance": 1000},
    }
    model = build(values).model()
    assert model.sizes == Gamma(mean=model.calibrated_diameter, std=0.5)
    assert model.strengths == Weibull(mean=250.0, std=40.0)


def test_the_least_matched_area_of_a_law_is_named() -> None:
    text = whole(law='"lognormal"', spread='"3 um"', calibration='"matched"')
    with pytest.raises(ScenarioRefused, match=r"2\.25 mean_junction_count \* spread\^2 = 405 um\^2"):
        loads(text)


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


@pytest.mark.parametrize(("key", "value"), [("exponent", "11"), ("smallest", "0"), ("largest", '"4"')])
def test_numbers_of_a_law_have_bounds(key: str, value: str) -> None:
    lines = [f"{key} = {value}" if line.startswith(key) else line for line in POWER.splitlines()]
    assert f"diameter.{key}: " in refusal(powered("\n".join(lines) + "\n"))


def test_matched_power_sizes_have_the_mean_area_asked_for() -> None:
    text = powered().replace('calibration = "paper"', 'calibration = "matched"')
    model = loads(text).model()
    assert model.calibration == "matched"
    assert model.stationary_mean_area == pytest.approx(model.mean_real_contact_area, rel=1e-13)


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


@pytest.mark.parametrize("value", ["1e-12", "1e-4", "3e-7"])
def test_a_tolerance_in_range_is_taken(value: str) -> None:
    slider = loads(with_tolerance(value)).model().slider
    assert slider is not None
    assert slider.tolerance == float(value)


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


def test_one_way_coupling_takes_no_tolerance() -> None:
    hint = 'write coupling = "two-way", or leave the tolerance out'
    head = f'run.toml:{LINE}: error: slider.tolerance: the coupling "one-way" takes no tolerance'
    said = refusal(with_tolerance("1e-9", WHOLE))
    assert said == shown(f'{head}, and "one-way" is the default', "tolerance = 1e-9", "1e-9", hint)
    said = refusal(with_tolerance("1e-9", TWO_WAY.replace("two-way", "one-way")))
    assert said.startswith(head.replace(f":{LINE}:", f":{LINE + 1}:") + "\n")


def test_coupling_alone_makes_no_slider() -> None:
    """Without a slider nothing can push back: what a slider has is asked for, at the key that asks for one."""
    text = TWO_WAY[: TWO_WAY.index("mass = ")] + 'coupling = "two-way"\n'
    said = refusal(text)
    line = 1 + text[: text.index("[slider]")].count("\n")
    for key, example in (
        ("damping", '"0.05 N*s/m" or damping_ratio = 0.02'),
        ("mass", '"5 g"'),
        ("stiffness", '"300 N/m"'),
    ):
        assert f"run.toml:{line}: error: slider.{key}: missing" in said
        assert f"write {key} = {example}" in said
    assert "sliding.speed: missing" in refusal(TWO_WAY.replace('speed = "1 mm/s"\n', ""))
    assert "strength.mean: missing" in refusal(TWO_WAY.replace('[strength]\nmean = "250 MPa"\n', ""))


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ("250 MPa", "0 MPa", "strength.mean"),
        ("300 N/m", "0 N/m", "slider.stiffness"),
        ("1 mm/s", "0 mm/s", "sliding.speed"),
        ("1 mm/s", "-1 mm/s", "sliding.speed"),
        ("200 um^2", "0 um^2", "interface.mean_real_contact_area"),
    ],
)
def test_a_contact_that_bears_nothing_by_its_keys_is_refused(old: str, new: str, key: str) -> None:
    said = refusal(TWO_WAY.replace(f'"{old}"', f'"{new}"'))
    assert f"error: {key}: must be above 0" in said
    assert f'"{new}"' in said


def test_a_contact_that_bears_nothing_here_and_there_is_taken() -> None:
    """G = 0 is a place like any other: before the first birth of an empty start, and between junctions that are few."""
    few = TWO_WAY.replace("mean_junction_count = 20", "mean_junction_count = 0.2")
    few = few.replace('distance = "20 mm"', 'distance = "2 mm"\nstart = "empty"').replace("0.1 um", "1 um")
    record = rubnoise.simulate(loads(few))
    slider, area = record["slider"], record["trace"]["real_contact_area"]
    assert area[0] == 0.0
    assert (area == 0.0).mean() > 0.5
    free = (slider["phase"] != 1) & (slider["friction_force"] == 0.0)
    assert free.any()
    assert np.isfinite(slider["displacement"]).all()


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ('"two_way"', 'unknown value "two_way"'),
        ('""', 'unknown value ""'),
        ("true", "needs a word in quotation marks, not a boolean"),
        ("2", "needs a word in quotation marks, not a"),
    ],
)
def test_another_coupling_is_refused(value: str, said: str) -> None:
    head = f"run.toml:{LINE}: error: slider.coupling: "
    told = refusal(TWO_WAY.replace('"two-way"', value))
    assert told.startswith(head)
    assert said in told
    assert "two-way" in told.splitlines()[-1]


def test_an_intervention_is_refused_before_anything_runs(tmp_path: Any) -> None:
    def process(env: Any, _live: Any) -> Any:
        yield env.timeout(1.0)

    with pytest.raises(Refused, match=r'slider\.coupling = "one-way" takes interventions'):
        rubnoise.simulate(loads(TWO_WAY), intervene=process)
    with pytest.raises(Refused, match=r'slider\.coupling = "one-way" takes interventions'):
        rubnoise.run(loads(TWO_WAY), tmp_path / "x.h5", intervene=process)
    assert not list(tmp_path.iterdir())


def test_a_sweep_cannot_ask_for_the_validity_of_what_is_not_there(tmp_path: Any) -> None:
    path = tmp_path / "sweep.toml"
    sweep = '\n[sweep]\nkeep = "summary"\nprecision = 0.1\nquantity = "{}"\n[sweep.grid]\nslider.coupling = {}\n'
    path.write_text(TWO_WAY.replace('coupling = "two-way"\n', "") + sweep.format("one_way_validity", '["two-way"]'))
    with pytest.raises(Refused, match="one_way_validity is no quantity of a run with two-way coupling"):
        load_sweep(path)
    path.write_text(
        TWO_WAY.replace('coupling = "two-way"\n', "") + sweep.format("velocity_std", '["one-way", "two-way"]')
    )
    assert [case.scenario.model().is_two_way for case in load_sweep(path).cases] == [False, True]


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
