"""Loading: defaults, what is needed, files on files, settings on top, limits, and values from Python."""

import json
import os
from collections.abc import Callable
from dataclasses import replace
from math import pi, sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from rubnoise.contact.distributions import Fixed, Normal
from rubnoise.errors import ScenarioRefused
from rubnoise.model import Slider
from rubnoise.scenario import build, load, loads
from tests.unit.scenarios import BARE, WHOLE, refusal, whole


def test_the_whole_scenario_becomes_a_model() -> None:
    model = loads(WHOLE).model()
    assert model.calibrated_diameter == pytest.approx(5.5300126, abs=5e-8)
    assert model.sizes == Normal(centre=model.calibrated_diameter, std=0.2)
    assert model.mean_birth_spacing == pytest.approx(0.55300126, abs=5e-9)
    assert model.strengths is not None
    assert (model.strengths.mean, model.sliding_speed, model.distance) == (250.0, 1000.0, 20_000.0)
    assert model.slider == Slider(mass=0.005, stiffness=300.0, damping=0.05)
    assert (model.tick, model.tick_count) == (0.1, 200_000)


def test_a_bare_scenario_has_the_defaults() -> None:
    scenario = loads(BARE)
    model = scenario.model()
    diameter = model.calibrated_diameter
    assert diameter == pytest.approx((3 * 10) ** 0.5, rel=1e-15)
    assert (model.sizes, model.calibration, model.start) == (Fixed(value=diameter), "matched", "stationary")
    assert (model.strengths, model.sliding_speed, model.slider) == (None, None, None)
    assert model.tick == diameter / 100
    assert (scenario.run.seed, scenario.run.engine, scenario.output.compression) == (1, "events", "none")


def test_a_damping_ratio_gives_the_damping() -> None:
    scenario = loads(WHOLE.replace('damping = "0.05 N*s/m"', "damping_ratio = 0.02"))
    slider = scenario.model().slider
    assert slider is not None
    assert slider.damping_ratio == pytest.approx(0.02, rel=1e-15)
    assert scenario.resolved()["slider"]["damping_ratio"] == 0.02
    assert "damping" not in scenario.resolved()["slider"]


LOADED = BARE.replace('mean_real_contact_area = "200 um^2"', 'load = "0.2 N"\nhardness = "1 GPa"')


def test_a_load_and_a_patch_give_area_and_count() -> None:
    named, loaded = loads(BARE).model(), loads(LOADED).model()
    assert replace(loaded, hardness=None) == named
    assert (loaded.load, named.load) == (200_000.0, None)
    patch = loads(LOADED.replace("mean_junction_count = 20", 'patch_area = "10 um^2"'))
    assert replace(patch.model(), hardness=None) == named
    doubled = patch.replace(load="0.4 N").model()
    assert (doubled.mean_junction_count, doubled.calibrated_diameter) == (40.0, named.calibrated_diameter)
    assert patch.replace(mean_real_contact_area="200 um^2", mean_junction_count=20).model() == named
    assert build(patch.resolved()).model() == patch.model()


WEIGHED = (
    LOADED.replace('distance = "20 mm"', 'speed = "1 mm/s"\ndistance = "20 mm"')
    + """\
[load]
height_scale = "0.5 um"
mass = "5 g"
damping_ratio = 0.05
"""
)


def test_a_load_that_weighs_sets_its_contact() -> None:
    scenario = loads(WEIGHED)
    model, shape = scenario.model(), scenario.pulse.shape
    assert (shape, scenario.birth.law, scenario.diameter.law) == ("parabola", "poisson", "weibull")
    assert model.sizes.std / model.sizes.mean == pytest.approx(sqrt(4.0 / pi - 1.0), rel=1e-12)
    assert model.sizes.moment(2) == pytest.approx(4.0 * 200.0 / (pi * 20.0), rel=1e-12)
    said = '[pulse]\nshape = "parabola"\n[diameter]\nlaw = "weibull"\nspread = "52.2723 %"\n[birth]\nlaw = "poisson"\n'
    assert loads(WEIGHED + said).model().sizes.std == pytest.approx(model.sizes.std, rel=1e-5)


@pytest.mark.parametrize(
    ("distance", "tick", "count"),
    [("0.3 um", "0.1 um", 3), ("20 mm", "0.1 um", 200_000), ("1 inch", "0.1 um", 254_000), ("0.7 um", "0.1 um", 7)],
)
def test_the_number_of_ticks_is_the_exact_floor_as_written(distance: str, tick: str, count: int) -> None:
    assert loads(whole(distance=f'"{distance}"', tick=f'"{tick}"')).model().tick_count == count
    assert 0.3 // 0.1 == 2.0  # what floats make of the first


def test_settings_go_on_top() -> None:
    scenario = loads(WHOLE, overrides=["sliding.distance=3 mm", 'output.tick="0.2 um"', "run.seed = 9"])
    assert (scenario.sliding.distance, scenario.output.tick, scenario.run.seed) == (3000.0, 0.2, 9)
    assert loads(WHOLE, overrides=["run.seed=1", "run.seed=2"]).run.seed == 2
    assert loads(WHOLE, overrides=["slider={start='rest'}"]).slider.start == "rest"  # type: ignore[union-attr]
    assert loads(BARE, overrides=["strength.mean=1 GPa"]).model().strengths.mean == 1000.0  # type: ignore[union-attr]
    anew = loads(WHOLE, overrides=["slider.damping_ratio=0.25", "interface.load=1 N", "interface.hardness=2 GPa"])
    assert (anew.slider.damping, anew.slider.damping_ratio) == (None, 0.25)  # type: ignore[union-attr]
    assert (anew.interface.mean_real_contact_area, anew.interface.load) == (None, 1e6)


def write(folder: Path, **files: str) -> Path:
    for name, text in files.items():
        (folder / f"{name}.toml").write_text(text, encoding="utf-8")
    return folder / f"{next(iter(files))}.toml"


def test_a_file_extends_another_deeply(tmp_path: Path) -> None:
    (tmp_path / "more").mkdir()
    write(tmp_path, base=WHOLE)
    path = write(tmp_path / "more", top='format = 1\nextends = "../base.toml"\n[slider]\nmass = "7 g"\n')
    scenario = load(path, ["run.seed=3"])
    assert scenario.slider is not None
    assert (scenario.slider.mass, scenario.slider.stiffness, scenario.run.seed) == (0.007, 300.0, 3)
    assert scenario.text == path.read_text(encoding="utf-8")
    assert "extends" not in scenario.resolved()


def test_a_problem_names_the_file_and_line_that_has_the_key(tmp_path: Path) -> None:
    base = whole(distance='"1,5 mm"')
    path = write(tmp_path, top='format = 1\nextends = "base.toml"\n[run]\nseed = "x"\n', base=base)
    with pytest.raises(ScenarioRefused) as refused:
        load(path)
    assert [line for line in str(refused.value).splitlines() if "error:" in line] == [
        f"{path}:4: error: run.seed: needs a number, not a text",
        f"{tmp_path / 'base.toml'}:18: error: sliding.distance: a comma in a number",
    ]


@pytest.mark.parametrize(
    ("files", "message"),
    [
        ({"a": "b", "b": "a"}, "extends a file that extends this one"),
        ({"a": "a"}, "extends a file that extends this one"),
        ({"a": "nowhere"}, "nowhere.toml: no such file or directory"),
        ({f"a{n}": f"a{n + 1}" for n in range(12)}, "more than 8 files extend one another"),
    ],
)
def test_files_that_do_not_lead_to_a_base(tmp_path: Path, files: dict[str, str], message: str) -> None:
    texts = {name: f'format = 1\nextends = "{base}.toml"\n' for name, base in files.items()}
    with pytest.raises(ScenarioRefused) as refused:
        load(write(tmp_path, **texts))
    assert f":2: error: extends: {message}" in str(refused.value)


@pytest.mark.parametrize(
    ("base", "reason"),
    [
        ("missing.toml", "no such file or directory"),
        ("", "is not a regular file"),
        (".", "is not a regular file"),
        ("/dev/zero", "not a regular file"),
        ("pipe", "not a regular file"),
        ("loop", "too many levels of symbolic links"),
        ("a\\u0000b", "embedded null byte"),
        ("x" * 300, "file name too long"),
    ],
)
def test_what_is_no_file_is_not_extended(tmp_path: Path, base: str, reason: str) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "loop").symlink_to("loop")
    path = write(tmp_path, top=f'format = 1\nextends = "{base}"\n')
    with pytest.raises(ScenarioRefused) as refused:
        load(path)
    assert ":2: error: extends: " in str(refused.value)
    assert reason in str(refused.value)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"#" * 65_537, "larger than 64 kB"),
        (b"format = 1\ntitle = '\xff'\n", ":2: error: not UTF-8 text"),
        (b"#" * 1001, ":1: error: a line of more than 1000 characters"),
        (b"x = " + b"[\n" * 20_000, ":1: error: nested too deeply"),
    ],
)
def test_a_strangers_file_is_bounded(tmp_path: Path, content: bytes, message: str) -> None:
    (path := tmp_path / "a.toml").write_bytes(content)
    with pytest.raises(ScenarioRefused) as refused:
        load(path)
    assert message in str(refused.value)


def test_a_byte_order_mark_is_read_over(tmp_path: Path) -> None:
    (path := tmp_path / "a.toml").write_text(WHOLE, encoding="utf-8-sig")
    assert load(path).text == WHOLE


def test_windows_line_ends_are_read() -> None:
    assert loads(WHOLE.replace("\n", "\r\n")).model() == loads(WHOLE).model()
    assert "run.toml:18: error: sliding.distance" in refusal(whole(distance='"1,5 mm"').replace("\n", "\r\n"))


@pytest.mark.parametrize("text", [WHOLE, BARE, whole(spread='"20 %"'), whole(distance='"1 inch"')])
def test_the_resolved_scenario_is_the_same_scenario(text: str) -> None:
    scenario = loads(text)
    resolved = json.loads(json.dumps(scenario.resolved()))
    again = build(resolved)
    assert again.model() == scenario.model()
    assert again.resolved() == resolved


NUMBERS_OF_NUMPY = (np.float64, np.float32, np.float16, np.longdouble, np.int64, np.int32, np.uint8, np.array)


@pytest.mark.parametrize("number", NUMBERS_OF_NUMPY, ids=lambda kind: kind.__name__)
def test_python_may_give_the_numbers_of_numpy(number: Callable[[float], Any]) -> None:
    def values(kind: Callable[[float], Any], whole: Callable[[int], Any], text: Callable[[str], Any]) -> dict[str, Any]:
        return {
            "format": whole(1),
            "title": text("x"),
            "interface": {"mean_real_contact_area": kind(200), "mean_junction_count": kind(20)},
            "diameter": {"law": text("normal"), "spread": text("0.2 um")},
            "sliding": {"distance": kind(100), "speed": text("1 mm/s")},
            "strength": {"mean": kind(250)},
            "slider": {"mass": kind(5), "stiffness": kind(200), "damping_ratio": kind(2)},
            "run": {"seed": whole(7)},
        }

    scenario = build(values(number, np.uint16, np.str_))
    assert scenario == build(values(float, int, str))
    assert type(scenario.run.seed) is int
    assert json.dumps(scenario.resolved()) == json.dumps(build(values(float, int, str)).resolved())


def test_everything_that_is_wrong_is_said_at_once() -> None:
    """Keys, their combinations, and what follows from them: no table that is wrong hides what is wrong with others."""
    changed = WHOLE.replace("[run]", "[rum]").replace("damping =", 'coupling = "two-way"\ndamping =')
    changed = changed.replace('"300 N/m"', '"300 N"').replace('tick = "0.1 um"', 'tick = "1 m"\ntock = 3')
    changed += '[birth]\nlaw = "clustered"\n[load]\nheight_scale = "0.5 um"\nmass = "5 um"\ndamping = 1,5\n'
    assert {head.split(": ")[2] for head in refusal(changed).splitlines() if ": error: " in head} == {
        *("birth.cluster_size", "birth.cluster_width", "birth.law", "diameter.law", "diameter.spread"),
        *("interface.calibration", "interface.load", "load.damping", "load.mass", "output.tick", "output.tock"),
        *("rum", "slider.coupling", "slider.stiffness"),
    }
