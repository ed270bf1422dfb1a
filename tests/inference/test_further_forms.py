"""Further forms of one trace: each is read by `infer` and Trace alike, or refused by its cell and a way out."""

import gzip
import io
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
from tests.inference.test_forms import FORCE, HEAD, MARKS, PLAIN, TABS, TIME, Form, form, german, kept, table, written

RATE = {"rate": "2500 Hz"}
ENDED = table(HEAD, PLAIN)
LINES = ENDED.splitlines(keepends=True)


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


READ = {
    # instruments
    "oscilloscope": form("Time,Channel A\n(s),(mV)\n\n", unit="mN"),
    "increment": form(
        "X,CH1,Start,\nSequence,Volt,4e-4,\n", "{n},{f:.5f},,\n", column="CH1", unit="mN", from_="2", **RATE
    ),
    "settings beside": form("", '"Points",2500,,{t:.4f},{f:.5f}\n', column="5", unit="mN", **RATE),
    "amplifier": german("Messung=Rig 3\nDatum=05.03.2024\n\nZeit\tKraft\ns\tmN\n", TABS),
    "trailing tab": german("Time [s]\tFt [mN]\tµ\n", "{t:.4f}\t{f:.5f}\t0,12\t\n", column="Ft"),
    "forces": form("T (s)\tFx (mN)\tFz (N)\tCOF\n", "{t:.4f}\t{f:.5f}\t0.02\t0.1\n", column="Fx"),
    "data frame": form(",time (s),force (mN)\n", "{n},{t:.4f},{f:.5f}\n", column="force"),
    "statistics": form('"","t..s.","F..mN."\n', '"{n}",{t:.4f},{f:.5f}\n', column="F..mN.", unit="mN", **RATE),
    "spreadsheet": german("sep=;\r\nZeit (s);Kraft (mN)\r\n", "{t:.4f};{f:.5f}\r\n"),
    "counted": german("Nr\tZeit [s]\tKraft [mN]\n", "{n}\t{t:.4f}\t{f:.5f}\n", column="Kraft"),
    # lines and letters
    "mark of bytes": kept(("\ufeff" + ENDED).replace("\n", "\r\n")),
    "old Macintosh": kept(ENDED.replace("\n", "\r")),
    "big ends": kept(("\ufeff" + ENDED).encode("utf-16-be")),
    "blank lines": kept(ENDED.replace("\n", "\r\r\n")),
    "remark at the end": kept(ENDED + "# stopped by hand\n"),
    "nothing at the end": kept(ENDED + "\n\n\n"),
    # names and units
    "after a comma": form("Time, s\tForce, mN\n", TABS),
    "symbol and unit": german("t/s;F_R/mN\n", MARKS),
    "in words": german("Zeit t in s;Reibkraft FR in mN\n", MARKS),
    "Greek mu": form("time (s),force (\u03bcN)\n", PLAIN, 1000.0 * FORCE),
    "milliseconds": form("time (ms),force (mN)\n", "{n}.0,{f:.5f}\n", **RATE),
    "German seconds": form("time (Sekunden);force (mN)\n", MARKS),
    "epoch": form("timestamp (s),force (mN)\n", "17096292{n:02d},{f:.5f}\n", **RATE),
    "distance": form("Sliding distance (mm),force (mN)\n"),
    "humidity": form("time (s),humidity (%),force (mN)\n", "{t:.4f},45,{f:.5f}\n", column="force"),
    # numbers and times
    "minutes": kept("t (min),F (mN)\n" + "".join(f"{t / 60},{f}\n" for t, f in zip(TIME, FORCE, strict=True))),
    "days": kept("t (d),F (mN)\n" + "".join(f"{t / 86400},{f}\n" for t, f in zip(TIME, FORCE, strict=True))),
    "narrow spaces": kept(table("t (s);F (µN)\n", "{t:.4f};{f:,.2f}\n", 1e3 * FORCE).replace(",", "\u202f")),
    "plus": form(HEAD, "+{t:.4f},+{f:.5f}\n"),
    "American dates": form("when,force (mN)\n", "{moment:%m/%d/%Y %H:%M:%S.%f},{f:.5f}\n"),
    "cut last row": kept(ENDED + "9.9", to=f"{FORCE.size}"),
    # other kinds of files
    "MATLAB": binary(
        ".mat", lambda to: savemat(to, {"t": TIME, "F": FORCE[:, None], "rig": "3"}), unit="mN", column="F"
    ),
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
    "coarse clock": (form("Uhrzeit,force (mN)\n", "{moment:%H:%M:%S},{f:.5f}\n"), ["Uhrzeit", "rate"]),
    "two forces": (form("t (s),Fx (mN),Fy (mN)\n", "{t:.4f},{f:.5f},1.0\n"), ["column", "Fx", "Fy"]),
    "no unit": (form("time (s),force\n"), ["force", "unit"]),
    "no time": (form("force (mN)\n", "{f:.5f}\n"), ["rate"]),
    "packed text": (kept(gzip.compress(ENDED.encode()), ".csv.gz"), ["gz"]),
    "packed arrays": (binary(".npz", lambda to: np.savez(to, force=FORCE)), ["npz"]),
    "workbook": (binary(".xlsx", lambda to: np.savez(to, force=FORCE)), ["CSV"]),
    "objects": (kept('{"force": [1.5, 2.5]}', ".json"), ["line 1"]),
    "two columns": (binary(".h5:/rig/both", hdf5, **RATE), ["both"]),
    "no MATLAB": (kept("text", ".mat"), ["-v6 or -v7"]),
    "channels": (binary(".wav", lambda to: wavfile.write(to, 2500, np.c_[FORCE, FORCE])), ["1, 2"]),
    "one row": (kept("".join(LINES[:2])), ["1 rows"]),
    "whole file": (binary(".h5", hdf5, **RATE), ["rig/force"]),
    "unheard option": (kept(ENDED, dt="0.4 ms"), ["dt=", "rate"]),
}
INFER_ALONE = ("two forces", "no unit", "channels")
"""A Trace keeps several columns, and those without a unit."""


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
    for read in readers[name in INFER_ALONE :]:
        with pytest.raises(Refused) as refused:
            read(written(tmp_path, form), **form[2])
        said = str(refused.value)
        assert [word for word in words if word not in said] == []
        assert "\n" not in said
