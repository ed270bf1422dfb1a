"""Measured traces in files: what is read, and what is refused by name and line."""

import json
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pint
import pytest

import rubnoise
from rubnoise.api.inferring import infer
from rubnoise.errors import Refused, in_shell
from rubnoise.storage.measured import Asked
from tests.inference.traces import contact, read_measured, signal
from tests.shell.terminal import call, spawn

FORCE = np.round(50.0 + np.sin(np.arange(40.0)), 4)


@pytest.fixture(scope="module")
def contact_csv(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A trace of 450 lives over time, at 1 mm/s, in mN."""
    made = signal(contact("normal", 0.2, 20, 450), 5)
    path = tmp_path_factory.mktemp("csv") / "friction.csv"
    times = made.tick / 1000.0 * np.arange(made.values.size)
    rows = "\n".join(f"{t:.9f},{v / 1000.0:.6f}" for t, v in zip(times.tolist(), made.values.tolist(), strict=True))
    path.write_text(f"time (s),force (mN)\n{rows}\n", encoding="utf-8")
    return path


def written(path: Path, text: str) -> Path:
    path.write_text(text, encoding="utf-8")
    return path


ROWS = [f"{0.1 * n:.1f},{50.0 + np.sin(n):.4f}" for n in range(200)]


@pytest.mark.parametrize(
    ("rows", "head", "options", "problem"),
    [
        (ROWS[:60] + ROWS[61:], "time (s),force (mN)", {}, "line 63: time grows by 0.2 s where the usual step is 0.1"),
        (
            [*ROWS[:7], "0.7,nan", *ROWS[8:]],
            "time (s),force (mN)",
            {},
            "line 10: force is nan; every sample needs a number",
        ),
        ([*ROWS[:7], "0.7,", *ROWS[8:]], "time (s),force (mN)", {}, "line 10: force: '' is no number"),
        (
            [f"{0.1 * n:.1f},{min(np.sin(0.05 * n), 0.5):.4f}" for n in range(200)],
            "time (s),force (mN)",
            {},
            "line 2: force: the sensor was clipped: 84 samples are at the largest value, 42 in a row, first at line 14",
        ),
        ([f"{row},1" for row in ROWS], "time (s),force (mN),load (mN)", {}, "column= takes one of: force, load"),
        (ROWS, "time (s),force", {}, 'line 2: force: no unit; unit="mN" names it'),
        (ROWS, "time,force", {}, 'line 2: time has no unit; write "time (s)"'),
        (ROWS, "time (s),force (mN)", {"speed": "-1 mm/s"}, "speed=: -1 mm/s is not above 0"),
        (
            [f"{0.1 * n:.1f},{-50.0 + np.sin(n):.4f}" for n in range(200)],
            "time (s),force (mN)",
            {"zero": "known"},
            "line 2: force: nearly all values are negative, first at line 3: with a known zero the force",
        ),
    ],
)
def test_a_bad_trace_is_refused_by_name_and_line(
    tmp_path: Path, rows: list[str], head: str, options: dict[str, str], problem: str
) -> None:
    path = written(tmp_path / "bad.csv", "\n".join(["# of a tribometer", head, *rows, ""]))
    with pytest.raises(Refused) as refused:
        infer(path, **({"speed": "1 mm/s"} | options))  # type: ignore[arg-type]
    assert problem in str(refused.value)
    if "speed" not in options:
        assert str(refused.value).startswith(f"{path}: ")
    words = [word for name, value in ({"speed": "1 mm/s"} | options).items() for word in (f"--{name}", value)]
    answer = call("infer", str(path), *words, "-o", str(tmp_path / "found.toml"), "--json")
    assert (answer.code, answer.out) == (2, "")
    assert in_shell(problem) in answer.err
    assert [each.name for each in tmp_path.iterdir()] == ["bad.csv"]


def test_a_dataset_has_the_steps_of_its_scale(tmp_path: Path) -> None:
    path = tmp_path / "a.h5"
    with h5py.File(path, "w") as file:
        file["force"], file["time"] = FORCE, 0.01 * np.arange(40.0) + 0.01 * (np.arange(40) > 13)
        file["time"].attrs["units"] = "s"
        file["time"].make_scale("time")
        file["force"].dims[0].attach_scale(file["time"])
    with pytest.raises(Refused, match=r"sample 15: time grows by 0\.02 s"):
        read_measured(f"{path}:force")


def test_a_dataset_in_another_file_is_not_read(tmp_path: Path) -> None:
    with h5py.File(tmp_path / "other.h5", "w") as other:
        other["force"] = FORCE
    with h5py.File(tmp_path / "a.h5", "w") as file:
        file["force"] = FORCE
        file["soft"] = h5py.SoftLink("group/force")
        file.create_group("group")["force"] = h5py.SoftLink("/force")
        file["round"] = h5py.SoftLink("round")
        file["elsewhere"] = h5py.ExternalLink("other.h5", "/force")
        file["led"] = h5py.SoftLink("elsewhere")
        file.create_dataset("outside", (40,), "<f8", external=[(str(tmp_path / "other.h5"), 0, 320)])
        layout = h5py.VirtualLayout((40,), "<f8")
        layout[:] = h5py.VirtualSource(str(tmp_path / "other.h5"), "force", (40,))
        file.create_virtual_dataset("virtual", layout)
    for name in ("force", "soft", "group/force"):
        assert read_measured(f"{tmp_path}/a.h5:{name}", Asked(rate=1.0)).values.tolist() == FORCE.tolist()
    for name, problem in (
        *((name, "is no dataset in it") for name in ("elsewhere", "led", "round", "elsewhere/x")),
        *((name, "has its values in other files") for name in ("outside", "virtual")),
    ):
        with pytest.raises(Refused, match=problem):
            read_measured(f"{tmp_path}/a.h5:{name}")


def test_an_array_needs_a_rate_and_a_unit() -> None:
    values = np.random.default_rng(1).standard_normal(500)
    with pytest.raises(Refused, match="rate="):
        infer(values, unit="mN", speed="1 mm/s")
    with pytest.raises(Refused, match="no unit"):
        infer(values, rate="1 kHz", speed="1 mm/s")
    with pytest.raises(Refused, match="sample 2 of trace is inf"):
        infer(np.array([1.0, np.inf]), rate="1 Hz", unit="N", speed="1 um/s")


@pytest.mark.slow
def test_a_unit_replaces_that_of_a_file_and_not_that_of_a_trace(contact_csv: Path) -> None:
    """A Trace is in uN already, whatever its file was in."""
    asked: dict[str, Any] = {"speed": "1 mm/s", "zero": "known", "law": "normal"}
    trace = rubnoise.Trace(contact_csv)
    plain = infer(contact_csv, **asked).estimates["shear_strength"].value
    assert infer(trace, unit="uN", **asked).estimates["shear_strength"].value == pytest.approx(plain)
    thousand = infer(contact_csv, unit="N", **asked).estimates["shear_strength"].value
    assert thousand == pytest.approx(1000.0 * plain)
    assert rubnoise.Trace(contact_csv, unit="N")["force"] == pytest.approx(1000.0 * trace["force"])
    carried = pint.UnitRegistry().Quantity(trace["force"], "uN")
    rate = {"rate": f"{1.0 / trace.step} Hz"}
    for known, more in ((trace, {}), (carried, rate)):
        with pytest.raises(Refused, match=r"unit=: mN: .* by its own words; leave unit= out"):
            infer(known, unit="mN", **asked, **more)


@pytest.mark.slow
def test_what_was_found_simulates_and_is_found_again(contact_csv: Path, tmp_path: Path) -> None:
    found = rubnoise.infer(contact_csv, speed="1 mm/s", zero="known", law="normal")
    scenario = rubnoise.load(written(tmp_path / "found.toml", found.to_toml()))
    model = scenario.model()
    assert model.sizes.mean == pytest.approx(found.estimates["diameter"].value, rel=1e-5)
    assert model.stationary_mean_area == pytest.approx(found.estimates["mean_real_contact_area"].value, rel=1e-5)
    assert 2.0 * model.birth_rate * model.sizes.mean == pytest.approx(found.estimates["junction_count"].value, rel=1e-5)
    with rubnoise.run(scenario, tmp_path / "again.h5") as run:
        assert len(run.trace) == model.tick_count + 1
    again = rubnoise.infer(tmp_path / "again.h5", zero="known", law="normal")
    for name in ("junction_count", "diameter", "relative_spread", "shear_strength"):
        first, second = found.estimates[name], again.estimates[name]
        error = np.hypot(first.standard_error / first.value, second.standard_error / second.value)
        assert abs(np.log(second.value / first.value)) <= 4.0 * error, name


@pytest.mark.slow
def test_the_bootstrap_agrees_with_the_errors(contact_csv: Path) -> None:
    found = infer(contact_csv, speed="1 mm/s", zero="known", law="normal", bootstrap=12)
    for name in ("junction_count", "diameter", "shear_strength"):
        ratio = found.bootstrap[name].standard_error / found.estimates[name].standard_error
        assert abs(np.log(ratio)) <= 4.0 / np.sqrt(2.0 * 11.0), name
        assert found.bootstrap[name].unit == found.estimates[name].unit


@pytest.mark.slow
def test_the_command_answers_in_json_and_writes_files(contact_csv: Path, tmp_path: Path) -> None:
    page, toml = tmp_path / "page.html", tmp_path / "found.toml"
    options = ["--speed", "1 mm/s", "--zero", "known", "--law", "normal"]
    done = spawn("infer", str(contact_csv), *options, "--json", "-o", str(toml), "--report", str(page))
    assert done.code == 0, done.err
    answer = json.loads(done.out)
    assert set(answer["estimates"]["diameter"]) == {"value", "error", "interval", "unit"}
    assert set(answer["estimates"]) == {
        "law",
        "junction_count",
        "diameter",
        "relative_spread",
        "shear_strength",
        "mean_real_contact_area",
        "noise",
    }
    assert set(answer["not_identified"]) == {"strength_spread"}
    assert (answer["failing"], answer["passed"]) == ([], True)
    assert 'law = "normal"' in toml.read_text(encoding="utf-8")
    text = page.read_text(encoding="utf-8")
    assert text.count("<svg") == 1
    assert "time reversal" in text
    again = spawn("infer", str(contact_csv), *options, "-o", str(toml))
    assert again.code == 2
    assert "--force" in again.err
