"""The laws of sizes and strengths in a scenario: what each takes, what it becomes, and how wide it may be."""

import pytest

from rubnoise.contact.laws import Exponential, Fixed, Gamma, Law, Lognormal, Normal, Power, Spread, Weibull, law_for
from rubnoise.errors import ScenarioRefused
from rubnoise.scenario import build, loads
from tests.unit.scenarios import BARE, WHOLE, refusal, whole

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
    model = loads(BARE + '[diameter]\nlaw = "exponential"\n').model()
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
    assert f'error: {table}.{key}: missing; the law "power" needs a {key}' in report


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
