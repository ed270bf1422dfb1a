"""Whatever a scenario holds, it is refused or runs right; whatever bit of a result is turned, it is noticed."""

import math
import re
import tomllib
from contextlib import suppress
from fractions import Fraction
from pathlib import Path
from shutil import copy
from typing import Any

import h5py
import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from rubnoise.contact.laws import Spread
from rubnoise.contact.pulses import LENS, PULSES
from rubnoise.errors import Refused, RunFileRefused, ScenarioRefused
from rubnoise.model import Model, Slider
from rubnoise.record.rows import MemoryRecord
from rubnoise.runs.verification import verify
from rubnoise.scenario import Scenario, build, loads
from rubnoise.scenario.text import read_toml
from rubnoise.storage.reader import open_run
from rubnoise.units import LENGTH, NUMBER, QuantityError, read_quantity
from tests.frozen import examples
from tests.models import UNEQUAL, contents, model, recorded
from tests.unit.scenarios import BARE, WHOLE
from tests.unit.tampering import flip, put_text, run_of

# Runs of random contacts: their rows and ticks are right, and they repeat to the bit.
BRIEF = settings(max_examples=40, suppress_health_check=[HealthCheck.too_slow])
FEW = settings(BRIEF, max_examples=20)

COUNTS = st.floats(-2.0, 2.7).map(lambda power: float(f"{10.0**power:.3g}"))
SPREADS = st.one_of(
    st.just(Spread()),
    st.floats(0.01, 3.0).map(lambda share: Spread(relative=share)),
    st.floats(0.01, 8.0).map(lambda std: Spread(absolute=std)),
)
SLIDERS = st.builds(
    Slider,
    mass=st.sampled_from([0.001, 0.005, 1.0]),
    stiffness=st.sampled_from([30.0, 300.0, 3e5]),
    damping=st.sampled_from([0.0, 0.05, 50.0]),
    start=st.sampled_from(["equilibrium", "rest"]),
)
SEEDS = st.integers(0, 2**53 - 1)


@st.composite
def models(draw: st.DrawFn) -> Model:
    """Return a model of at most a few thousand births and ticks."""
    count = draw(COUNTS)
    rough = 200.0 / count
    life = 2.0 * (rough / 0.327) ** 0.5
    births, ticks = draw(st.floats(0.0, 3000.0)), draw(st.integers(1, 800))
    distance = float(f"{max(births, 0.3) / count * life:.4g}")
    slider = draw(st.none() | SLIDERS)
    full = slider is not None
    pulse = draw(st.sampled_from(list(PULSES.values())))
    return model(
        count=count,
        spread=draw(SPREADS),
        calibration=draw(st.sampled_from(["paper", "exact"])) if pulse is LENS else "exact",
        distance=distance,
        tick=float(f"{distance / ticks:.4g}"),
        start=draw(st.sampled_from(["stationary", "empty"])),
        slider=slider,
        speed=draw(st.sampled_from([1e3, 1e5]) if full else st.none() | st.just(1e3)),
        strength=draw(st.sampled_from([250.0, UNEQUAL]) if full else st.sampled_from([None, 250.0, UNEQUAL])),
        births=draw(st.sampled_from(["poisson", "regular"])),
        pulse=pulse,
    )


def record_of(run: Model, seed: int) -> MemoryRecord | None:
    """Return the record of a run, or None where its slider would need too many steps."""
    with suppress(Refused):
        return recorded(run, seed)
    assert run.slider is not None
    return None


@BRIEF
@given(run=models(), seed=SEEDS)
def test_rows_and_ticks_are_sound(run: Model, seed: int) -> None:
    record = record_of(run, seed)
    if record is None:
        return
    sound_rows(run, record["junctions"])
    sound_trace(run, record)
    if run.slider is not None:
        sound_slider(run, record)


def sound_rows(run: Model, rows: dict[str, Any]) -> None:
    birth, diameter, death = rows["birth_distance"], rows["diameter"], rows["death_distance"]
    assert rows["junction"].tolist() == list(range(birth.size))
    assert np.all(np.diff(birth) >= 0.0)
    assert np.all(diameter > 0.0)
    assert np.array_equal(death, birth + 2.0 * diameter)
    assert np.array_equal(rows["life_distance"], 2.0 * diameter)
    assert np.all(birth <= run.distance)
    assert np.all(death >= 0.0)
    assert run.start == "stationary" or np.all(birth >= 0.0)
    assert np.array_equal(rows["state"] & 1 > 0, birth < 0.0)
    assert np.array_equal(rows["state"] & 2 > 0, death > run.distance)
    assert ("shear_strength" in rows) == (run.strengths is not None)
    assert ("birth_time" in rows) == (run.sliding_speed is not None)


def sound_trace(run: Model, record: MemoryRecord) -> None:
    rows, trace = record["junctions"], record["trace"]
    s = trace["distance"]
    assert np.array_equal(s, np.arange(run.tick_count + 1) * run.tick)
    born = np.searchsorted(rows["birth_distance"], s, side="right")
    died = np.searchsorted(np.sort(rows["death_distance"]), s, side="right")
    assert np.array_equal(trace["junction_count"], born - died)
    area = trace["real_contact_area"]
    assert np.all(area >= 0.0)
    assert not area[born == died].any()
    largest = np.max(rows["max_area"], initial=0.0)
    assert np.all(area <= trace["junction_count"] * largest * (1.0 + 1e-12))
    assert ("friction_force" in trace) == (run.strengths is not None)


def sound_slider(run: Model, record: MemoryRecord) -> None:
    slider, trace = record["slider"], record["trace"]
    assert np.array_equal(slider["distance"], trace["distance"])
    assert np.array_equal(slider["time"], trace["distance"] / run.sliding_speed)
    assert np.array_equal(slider["friction_force"], trace["friction_force"])
    assert slider["displacement"][0] == run.equilibrium_displacement
    assert slider["velocity"][0] == 0.0
    assert np.all(np.isfinite(slider["displacement"]))
    assert np.all(np.isfinite(slider["velocity"]))


@FEW
@given(run=models(), seed=SEEDS)
def test_a_seed_gives_the_same_bytes_twice(run: Model, seed: int) -> None:
    record = record_of(run, seed)
    if record is not None:
        assert contents(recorded(run, seed)) == contents(record)


# Whatever a file holds, it is a scenario or a report of what is wrong, and soon.
TOML_PIECES = st.sampled_from(
    ["[slider]", "[[a]]", "[", "]", "{", "}", "=", ".", ",", "\n", '"', "'", '"""', "'''", "#", "\\", "\\u0000", " ",
     "a", "1", "1,5 mm", '"1 mm"', "mass", "run.seed", "nan", "-inf", "true", "1979-05-27", "\r", "\x00", "\ud800"]
)  # fmt: skip
NUMBERS = st.one_of(
    st.integers(-(10**30), 10**30).map(str),
    st.floats(allow_nan=True).map(repr),
    st.decimals(allow_nan=False, allow_infinity=False, places=6).map(str),
    st.from_regex(NUMBER, fullmatch=True),
    st.text(alphabet="0123456789.,eE+-*/_ \u2212", max_size=12),
)
UNITS = st.one_of(
    st.sampled_from(
        ["um", "mm", "um^2", "um2", "mPa", "MPa", "N*s/m", "%", "m^9", "degC", "dB", "inch", "", "s", "N/m"]
    ),
    st.text(alphabet="umMPasNkg%^*/ .-0129\u00b5", max_size=14),
    st.text(max_size=6),
)
KEYS = st.sampled_from(
    ["interface.mean_real_contact_area", "interface.mean_junction_count", "interface.calibration", "diameter.law",
     "diameter.spread", "strength.mean", "sliding.speed", "sliding.distance", "slider.mass", "slider.damping",
     "slider.stiffness", "output.tick", "run.seed", "title", "format", "run", "sweep.replicates", "x"]
)  # fmt: skip


def outcome(text: str, *overrides: str) -> Scenario | str:
    """Return the scenario or the report; anything else is an error of the test."""
    try:
        return loads(text, "a.toml", overrides)
    except ScenarioRefused as refused:
        report = str(refused)
        assert report.replace("\n", "").isprintable()
        assert "error: " in report
        return report


@given(st.one_of(st.text(max_size=200), st.lists(TOML_PIECES, max_size=40).map("".join)))
def test_any_text_is_a_scenario_or_a_report(text: str) -> None:
    assert isinstance(outcome(text), str)


@given(st.lists(TOML_PIECES, max_size=12).map("".join), st.integers(0, len(WHOLE)), st.integers(0, 30))
def test_a_damaged_scenario_is_a_scenario_or_a_report(piece: str, at: int, cut: int) -> None:
    outcome(WHOLE[:at] + piece + WHOLE[at + cut :])


@given(KEYS, NUMBERS, UNITS, st.sampled_from(['"', ""]))
def test_any_number_and_unit_is_a_scenario_or_a_report(key: str, number: str, unit: str, quote: str) -> None:
    result = outcome(WHOLE, f"{key}={quote}{number} {unit}{quote}")
    if isinstance(result, Scenario):
        model = result.model()
        assert math.isfinite(model.stationary_mean_area)
        assert model.tick_count >= 1


def powers(low: float, high: float) -> st.SearchStrategy[float]:
    """Return numbers from 10^low to 10^high, evenly on a logarithmic axis."""
    return st.floats(low, high).map(lambda power: float(10.0**power))


@settings(max_examples=200)
@given(
    powers(-12, 18), powers(-6, 9), st.one_of(st.just(0.0), powers(-12, 12)),
    st.sampled_from(["paper", "exact", "matched"]), st.sampled_from(["um", "%"]),
)  # fmt: skip
def test_the_bounds_of_numbers_keep_the_model_finite(
    area: float, count: float, spread: float, calibration: str, unit: str
) -> None:
    values: dict[str, Any] = {
        "interface": {"mean_real_contact_area": area, "mean_junction_count": count, "calibration": calibration},
        "diameter": {"law": "normal", "spread": f"{spread!r} {unit}"},
        "sliding": {"distance": math.sqrt(area / count)},
    }
    try:
        model = build(values).model()
    except ScenarioRefused as refused:
        assert re.search("too (long|small|large)|no solution|alive at once", str(refused))  # noqa: PT017  (either way is right)
        return
    assert 0.0 < model.calibrated_diameter < math.inf
    assert math.isfinite(model.stationary_mean_area)
    if calibration == "matched":
        assert model.stationary_mean_area == pytest.approx(area, rel=1e-12)


@given(
    st.integers(1, 400), st.floats(0.5, 60.0), st.sampled_from(["0.2 um", "20 %", "0 um", "1e-2 inch"]),
    st.sampled_from(["paper", "exact", "matched"]), st.one_of(st.none(), st.floats(1e-3, 1.0)),
    st.integers(0, 2**53 - 1),
)  # fmt: skip
def test_resolved_scenarios_are_the_same_scenario(
    area: int, count: float, spread: str, calibration: str, tick: float | None, seed: int
) -> None:
    overrides = [
        f"interface.mean_real_contact_area={area} um^2", f"interface.mean_junction_count={count}",
        f"interface.calibration={calibration}", "diameter.law=normal", f"diameter.spread={spread}", f"run.seed={seed}",
        *([] if tick is None else [f"output.tick={tick:.5f} um"]),
    ]  # fmt: skip
    scenario = outcome(BARE, *overrides)
    if isinstance(scenario, Scenario):
        again = build(scenario.resolved())
        assert again.model() == scenario.model()
        assert again.resolved() == scenario.resolved()


PLAIN_KEYS = st.text(alphabet="abc-_1", min_size=1, max_size=3)
LEAVES = st.one_of(st.integers(0, 99).map(str), st.sampled_from(['"a # b"', "'c]'", "true", "1.5", "1979-05-27"]))
VALUES = st.recursive(
    LEAVES,
    lambda inner: st.one_of(
        st.lists(inner, max_size=3).map(lambda items: f"[ {', '.join(items)} ]"),
        st.dictionaries(PLAIN_KEYS, inner, max_size=2).map(
            lambda table: "{ " + ", ".join(f"{key} = {value}" for key, value in table.items()) + " }"
        ),
    ),
    max_leaves=6,
)


@given(st.dictionaries(PLAIN_KEYS, VALUES, max_size=4), st.dictionaries(PLAIN_KEYS, VALUES, max_size=4))
def test_the_locator_finds_every_value_that_tomllib_reads(top: dict[str, str], below: dict[str, str]) -> None:
    lines = [f"{key} = {value} # note" for key, value in top.items()]
    lines += ["[table.'sub']", *(f'"{key}" . x = {value}' for key, value in below.items())]
    source = read_toml("a.toml", "\n".join(lines))
    assert source.data == tomllib.loads(source.text)
    written = {(key,): value for key, value in top.items()} | {
        ("table", "sub", key, "x"): value for key, value in below.items()
    }
    for path, value in written.items():
        place = source.value_place(path)
        assert place.text[place.start : place.end] == value


@given(NUMBERS, UNITS)
def test_a_length_is_read_exactly_or_refused(number: str, unit: str) -> None:
    try:
        quantity = read_quantity(f"{number} {unit}", LENGTH)
    except QuantityError:
        return
    assert quantity.exact == Fraction(number.strip(" ")) * read_quantity(f"1 {unit.strip(' ')}", LENGTH).exact
    assert float(quantity) == float(quantity.exact)


# Whatever bit of whatever value of a result is turned, with its hash put right, verification finds it.
UNEQUAL_LAWS = {"diameter": {"law": "lognormal", "spread": "70 %"}, "strength": {"law": "lognormal", "spread": "60 %"}}
KINDS = {
    "one way": UNEQUAL_LAWS,
    "two ways": {**UNEQUAL_LAWS, "slider": {"coupling": "two-way"}},
    "off": {"pulse": {"offset": "uniform"}},
}


@pytest.fixture(scope="module", params=KINDS)
def result(tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest) -> Path:
    return run_of(tmp_path_factory.mktemp("verification") / "right.h5", **KINDS[request.param])


@pytest.mark.slow
@settings(max_examples=examples(8, 24), suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_any_bit_of_any_value_counts(result: Path, tmp_path: Path, data: st.DataObject) -> None:
    path = Path(copy(result, tmp_path / "x.h5"))
    with h5py.File(path) as file:
        column = data.draw(st.sampled_from([f"{group}/{name}" for group in file for name in file[group]]))
        size, bits = file[column].size, 8 * file[column].dtype.itemsize
    flip(path, column, data.draw(st.integers(0, size - 1)), data.draw(st.integers(0, bits - 1)))
    with open_run(path) as run:
        assert verify(run).different != []


OF_HDF5 = {"CLASS", "NAME", "DIMENSION_LIST", "REFERENCE_LIST"}
"""How HDF5 ties columns together for viewers; no value of the run."""
NEW_TEXTS = st.one_of(
    st.sampled_from(["", "0", "{}", "[]", "mm", "noise", "2026-11-21T05:09:14Z"]), st.text(max_size=9)
)
NEW_NUMBERS = st.one_of(st.sampled_from([0.0, 1.0, -1.0, math.nan]), st.floats(-1e9, 1e9))


def _changed(file: h5py.File, draw: Any) -> None:
    """Change an attribute of a file, take one away, or a column or a group, or add one that is not ours."""
    objects = ["/"]
    file.visit(objects.append)
    name = draw(st.sampled_from(objects))
    owner, kind = file[name], draw(st.sampled_from(["change", "change", "change", "lose", "lose the object", "add"]))
    attributes = sorted(set(owner.attrs) - OF_HDF5)
    if kind == "add" or name == "/":
        file.create_dataset(f"{name}/new" if isinstance(owner, h5py.Group) else f"{name}_new", data=[1.0])
    elif kind == "lose the object" or not attributes:
        del file[name]
    elif kind == "lose":
        del owner.attrs[draw(st.sampled_from(attributes))]
    else:
        attribute = draw(st.sampled_from(attributes))
        before = owner.attrs[attribute]
        if isinstance(before, bytes):
            new = draw(NEW_TEXTS.filter(lambda text: "\0" not in text and text.encode() != before))
            put_text(owner, attribute, new)
        else:
            new = np.asarray(draw(NEW_NUMBERS.filter(lambda number: not np.array_equal(number, before))))
            owner.attrs.modify(attribute, np.nan_to_num(np.broadcast_to(new, np.shape(before))).astype(before.dtype))
            assume(np.any(owner.attrs[attribute] != before))


@pytest.mark.slow
@settings(max_examples=examples(20, 40), suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_whatever_a_result_says_of_itself_counts(result: Path, tmp_path: Path, data: st.DataObject) -> None:
    path = Path(copy(result, tmp_path / "x.h5"))
    with h5py.File(path, "r+") as file:
        _changed(file, data.draw)
    with suppress(RunFileRefused), open_run(path) as run:
        assert verify(run).different != []
