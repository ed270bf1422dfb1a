"""Keywords of `infer` and of Trace, and the study that judges their intervals."""

import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import pint
import pytest

import rubnoise
from rubnoise.api.keywords import scale_of
from tests.inference.traces import contact, signal
from tests.shell.terminal import call
from tools.parts import parts_of
from tools.studies import inference as infer_study

# Keywords of `infer` and of Trace: quantities with a unit, refused in the words of Python and of the shell.
UNITS = pint.UnitRegistry()
MADE = signal(contact("fixed", 0.0, 20, 100), 3)
GIVEN = {"rate": f"{1000.0 / MADE.tick} Hz", "speed": "1 mm/s", "unit": "uN", "zero": "known", "law": "fixed"}


def inferred(**changed: Any) -> rubnoise.Inference:
    return rubnoise.infer(MADE.values, **(GIVEN | changed))


@pytest.mark.parametrize(
    ("unit", "scale"),
    [
        ("mN", 1e3),
        ("0.5 mN", 500.0),
        ("5e-1mN", 500.0),
        ("um^2", 1.0),
        ("newton", 1e6),
        ("kgf", 9806650.0),
        (UNITS("2 mN"), 2e3),
        (UNITS("3 nN"), 3e-3),
        ("V", None),
        ("0.1 V", None),
        ("2mV", None),
        (UNITS("5 V"), None),
    ],
)
def test_a_unit_is_a_force_an_area_or_a_voltage(unit: Any, scale: float | None) -> None:
    found, is_area, _ = scale_of(unit, "unit=")
    assert found == (None if scale is None else pytest.approx(scale, rel=1e-14))
    assert is_area == (unit == "um^2")


@pytest.mark.slow
def test_quantities_of_pint_are_those_of_texts() -> None:
    want = inferred(strength="250 MPa", mask="50 Hz")
    rate = UNITS.Quantity(1000.0 / MADE.tick, "Hz")
    got = inferred(
        rate=rate, speed=UNITS("1 mm/s"), unit=UNITS("1 uN"), strength=UNITS("0.25 GPa"), mask=[UNITS("50 Hz")]
    )
    assert got.intervals == want.intervals
    assert got.estimates["noise"].unit == "uN"
    trace = rubnoise.Trace.from_arrays({"time (s)": np.arange(400) / 100.0, "force (mN)": np.sin(np.arange(400.0))})
    assert trace.psd(segment=UNITS("500 ms")).place.tolist() == trace.psd(segment="0.5 s").place.tolist()
    assert trace.acf(longest=UNITS("200 ms")).lag.tolist() == trace.acf(longest="0.2 s").lag.tolist()


@pytest.mark.slow
def test_files_are_written_all_or_none(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.csv"
    rows = "\n".join(f"{MADE.tick * n:.9g},{value:.9g}" for n, value in enumerate(MADE.values.tolist()))
    path.write_text(f"distance (um),force (uN)\n{rows}\n", encoding="utf-8")
    words = ["infer", str(path), "--law", "fixed", "--zero", "known", "--json", "-o", str(tmp_path / "a.toml")]
    same = call(*words, "--report", str(tmp_path / "a.toml"))
    assert (same.code, same.out) == (2, "")
    write = Path.write_text

    def full(self: Path, text: str, **options: Any) -> int:
        if "html" in self.name:
            raise OSError(28, os.strerror(28))
        return write(self, text, **options)

    monkeypatch.setattr(Path, "write_text", full)
    answer = call(*words, "--report", str(tmp_path / "a.html"))
    assert (answer.code, answer.out) == (1, "")
    assert "a.html: writing failed" in answer.err
    assert [each.name for each in tmp_path.iterdir()] == ["a.csv"]


# The study of inference: the page shows its data, and each kind of cell is made and fitted.
def test_the_page_shows_the_data() -> None:
    data = json.loads(infer_study.COVERAGE.read_text(encoding="utf-8"))
    assert infer_study.tables(data) == parts_of(infer_study.PAGE.read_text(encoding="utf-8"))
    assert data.keys() == {infer_study.ALL, *(cell.name for cell in infer_study.cells())}


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "right normal 5",
        "outside two poles at 5 cycles a life",
        "outside two strokes",
        "right fixed 20",
        "drift normal 20",
        "wrong sine (zero unknown)",
    ],
)
def test_a_cell_is_made_and_fitted(name: str) -> None:
    cell = next(each for each in infer_study.cells() if each.name == name)
    row = infer_study.fit((cell, 1))
    assert row["refused"] is None
    if cell.kind == "wrong":
        assert row["flags"]
        return
    value, error, low, high = row["estimates"]["diameter"]
    assert low < value < high
    assert abs(value - row["true"]["diameter"]) <= 4.0 * error
