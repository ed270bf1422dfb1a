"""Further forms of one trace: each is read by `infer` and Trace alike, or refused by its cell and a way out."""

import gzip
import io
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from scipy.io import savemat, wavfile

import rubnoise
from rubnoise.api import inferring
from rubnoise.errors import Refused
from tests.inference import test_forms
from tests.inference.test_forms import FORCE, HEAD, PLAIN, TIME, table

Form = tuple[str, bytes, dict[str, str]]
TABLES = tomllib.loads(Path(__file__).with_name("further_forms.toml").read_text(encoding="utf-8"))
ENDED = table(HEAD, PLAIN)
LINES = ENDED.splitlines(keepends=True)


def kept(text: str | bytes, ending: str = ".csv", **options: str) -> Form:
    """Return ending, content and options of a file."""
    return ending, text if isinstance(text, bytes) else text.encode(), options


def binary(ending: str, write: Callable[[Any], Any], **options: str) -> Form:
    """Return the ending, the bytes and the options of another file."""
    stream = io.BytesIO()
    write(stream)
    return kept(stream.getvalue(), ending, **options)


def hdf5(stream: Any) -> None:
    with h5py.File(stream, "w") as file:
        for name, values, unit in (("force", FORCE, "mN"), ("time", TIME / 3600.0, "hours")):
            file[f"rig/{name}"] = values
            file[f"rig/{name}"].attrs["units"] = unit
        file["rig/time"].make_scale("time")
        file["rig/force"].dims[0].attach_scale(file["rig/time"])
        file["rig/both"] = np.c_[TIME, FORCE]


def spoiled(cell: str) -> str:
    """Return the plain table with another text for the force of line 102."""
    return "".join([*LINES[:101], LINES[101].replace(f"{FORCE[100]:.5f}", cell), *LINES[102:]])


READ = {name: kept(test_forms.written(form), **form.get("options", {})) for name, form in TABLES.items()} | {
    "mark of bytes": kept(("\ufeff" + ENDED).replace("\n", "\r\n")),
    "old Macintosh": kept(ENDED.replace("\n", "\r")),
    "big ends": kept(("\ufeff" + ENDED).encode("utf-16-be")),
    "blank lines": kept(ENDED.replace("\n", "\r\r\n")),
    "remark at the end": kept(ENDED + "# stopped by hand\n"),
    "nothing at the end": kept(ENDED + "\n\n\n"),
    "minutes": kept("t (min),F (mN)\n" + "".join(f"{t / 60},{f}\n" for t, f in zip(TIME, FORCE, strict=True))),
    "days": kept("t (d),F (mN)\n" + "".join(f"{t / 86400},{f}\n" for t, f in zip(TIME, FORCE, strict=True))),
    "cut last row": kept(ENDED + "9.9", to=f"{FORCE.size}"),
    "MATLAB": binary(".mat", lambda to: savemat(to, {"t": TIME, "F": FORCE[:, None], "x": "3"}), unit="mN", column="F"),
    "sound": binary(".wav", lambda to: wavfile.write(to, 2500, (FORCE / 100.0).astype("f4")), unit="100 mN"),
    "HDF5": binary(".h5:/rig/force", hdf5),
}
REFUSED: dict[str, tuple[Form, list[str]]] = {
    "gap": (kept("".join(LINES[:200] + LINES[201:])), ["line 201", "time"]),
    "empty cell": (kept(spoiled("")), ["line 102", "force"]),
    "word": (kept(spoiled("#N/A")), ["line 102", "force", "#N/A"]),
    "not a number": (kept(spoiled("NaN")), ["line 102", "force", "nan"]),
    "unit in a cell": (kept(spoiled("12.3 mN")), ["line 102", "force", "12.3 mN"]),
    "second head": (kept(ENDED + ENDED), [f"line {FORCE.size + 2}", "time"]),
    "backwards": (kept(HEAD + "".join(reversed(LINES[1:]))), ["time"]),
    "coarse clock": (kept(table("Uhrzeit,force (mN)\n", "{moment:%H:%M:%S},{f:.5f}\n")), ["Uhrzeit", "rate"]),
    "no time": (kept(table("force (mN)\n", "{f:.5f}\n")), ["rate"]),
    "packed text": (kept(gzip.compress(ENDED.encode()), ".csv.gz"), ["gz"]),
    "workbook": (binary(".xlsx", lambda to: np.savez(to, force=FORCE)), ["CSV"]),
    "objects": (kept('{"force": [1.5, 2.5]}', ".json"), ["line 1"]),
    "two columns": (binary(".h5:/rig/both", hdf5, rate="2500 Hz"), ["both"]),
    "no MATLAB": (kept("text", ".mat"), ["-v6 or -v7"]),
    "one row": (kept("".join(LINES[:2])), ["1 rows"]),
    "whole file": (binary(".h5", hdf5, rate="2500 Hz"), ["rig/force"]),
}


def written(folder: Path, form: Form) -> str:
    """Write a file, and return how it is named, with the dataset within."""
    ending, _, dataset = form[0].partition(":")
    (folder / f"a{ending}").write_bytes(form[1])
    return f"{folder}/a{ending}:{dataset}".removesuffix(":")


@pytest.mark.parametrize("name", READ)
def test_a_further_form_is_read(tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    path, keys = written(tmp_path, READ[name]), dict[str, Any](READ[name][2])
    trace = rubnoise.Trace(path, **keys)
    (force,) = [each for each in trace if trace.units[each] == "uN"]
    np.testing.assert_allclose(trace[force], 1000.0 * FORCE, rtol=1e-5)
    step, speed = ((0.4, "um"), {}) if name == "distance" else ((4e-4, "s"), {"speed": "1 mm/s"})
    assert (trace.step, trace.units[trace.place]) == (pytest.approx(step[0], rel=1e-5), step[1])
    read: list[Any] = []
    monkeypatch.setattr(inferring, "infer_signal", lambda signal, **_: read.append(signal) or 1 / 0)
    with pytest.raises(ZeroDivisionError):
        rubnoise.infer(path, **speed, **keys)
    np.testing.assert_allclose(read[0].scale * read[0].values, trace[force], rtol=1e-12)
    assert read[0].tick == pytest.approx(0.4, rel=1e-5)


@pytest.mark.parametrize("name", REFUSED)
def test_a_further_form_is_refused_by_its_place(tmp_path: Path, name: str) -> None:
    form, words = REFUSED[name]
    readers: list[Callable[..., Any]] = [
        rubnoise.Trace,
        lambda path, **keys: rubnoise.infer(path, speed="1 mm/s", **keys),
    ]
    for read in readers:
        with pytest.raises(Refused) as refused:
            read(written(tmp_path, form), **form[2])
        said = str(refused.value)
        assert [word for word in words if word not in said] == []
        assert "\n" not in said
