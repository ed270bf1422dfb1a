"""One trace in the forms of testers: `infer` and Trace read the same of each, or refuse it in words."""

import tomllib
from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from scipy.io import netcdf_file

import rubnoise
from rubnoise.errors import Refused
from tests.inference.traces import contact, read_measured, signal
from tests.shell.terminal import call

FORCE = np.round(signal(contact("normal", 0.2, 20, 12), 5).values / 1000.0, 5)
TIME = np.arange(FORCE.size) / 2500.0
BEGUN = datetime(2024, 3, 5, 23, 59, 59, 900_000, tzinfo=UTC)
SPOILED = FORCE.copy()
SPOILED[100] = -9999.0


def table(head: str, row: str, force: Any = FORCE, *, comma: bool = False) -> str:
    """Return a text with a row for each sample, of which t is the time, f the force and moment the time of day."""
    rows = [
        row.format(t=t, f=f, n=n, moment=BEGUN + timedelta(seconds=float(t)))
        for n, (t, f) in enumerate(zip(TIME.tolist(), force.tolist(), strict=True))
    ]
    return head + "".join(each.replace(".", ",") if comma else each for each in rows)


PLAIN = "{t:.4f},{f:.5f}\n"
HEAD = "time (s),force (mN)\n"
FORMS = tomllib.loads(Path(__file__).with_name("forms.toml").read_text(encoding="utf-8"))


def written(form: dict[str, Any]) -> str:
    """Return the text of a form."""
    force = form.get("times", 1.0) * FORCE
    text = table(form.get("head", HEAD), form.get("row", PLAIN), force, comma=form.get("comma", False))
    return text.translate(str.maketrans(*form.get("letters", ("", "")))) + form.get("below", "")


@pytest.mark.parametrize("name", FORMS)
def test_a_form_is_read(tmp_path: Path, name: str) -> None:
    options, encoding = FORMS[name].get("options", {}), FORMS[name].get("encoding", "utf-8")
    path = tmp_path / "a.csv"
    path.write_bytes(written(FORMS[name]).encode(encoding))
    options = {key: value.replace("SIZE", f"{FORCE.size}") for key, value in options.items()}
    keys = {key if key != "from" else "from_": value for key, value in options.items()}
    trace = rubnoise.Trace(path, **keys)  # type: ignore[arg-type]
    force = next(each for each in trace if trace.units[each] == "uN")
    np.testing.assert_allclose(trace[force], 1000.0 * FORCE, rtol=1e-7)
    assert (trace.units[trace.place], trace.step) == ("s", pytest.approx(4e-4, rel=1e-6))
    found = rubnoise.infer(path, speed="1 mm/s", law="fixed", pulse="lens", **keys)  # type: ignore[arg-type]
    np.testing.assert_allclose(found.signal.scale * found.signal.values, 1000.0 * FORCE, rtol=1e-7)
    assert found.signal.tick == pytest.approx(0.4, rel=1e-6)
    assert any(encoding[-4:] in note for note in found.signal.notes) == (encoding == "cp1252")
    words = [word for key, value in options.items() for word in (f"--{key}", value)]
    if words:
        assert call("infer", str(path), "--speed", "1 mm/s", "--law", "fixed", *words).code in (0, 3)


@pytest.mark.parametrize(
    ("text", "options", "words"),
    [
        (lambda: table(HEAD, PLAIN, SPOILED), {}, ["line 102", "-9999"]),
        (lambda: table(HEAD, "{t:.4f},{f:.5g}\n", np.where(SPOILED < 0, 9.91e37, FORCE)), {}, ["line 102", "9.91e+37"]),
        (lambda: table(HEAD, PLAIN).replace(f"{TIME[100]:.4f},", f"{TIME[100]:.4f},OVLD"), {}, ["line 102", "OVLD"]),
        (lambda: table(HEAD, PLAIN) + "Test completed\n", {}, [f"line {FORCE.size + 2}", "1 cells; there are 2 names"]),
        (lambda: table("time (s),F (g)\n", PLAIN), {}, ["F", "unit of a mass", 'unit="9.80665 mN"']),
        (lambda: table("time (s),p (N/mm²)\n", PLAIN), {}, ["p", "unit of a stress", 'unit="mN"']),
        (lambda: table(HEAD, PLAIN), {"fs": "2500 Hz"}, ["fs=", 'right form: rate="2500 Hz"']),
        (lambda: table(HEAD, PLAIN), {"place": "force"}, ["place=: force has mN"]),
        (lambda: table(HEAD, PLAIN, np.maximum(FORCE, np.quantile(FORCE, 0.1))), {}, ["smallest value", "range"]),
    ],
)
def test_what_is_no_force_is_said_by_its_place(
    tmp_path: Path, text: Callable[[], str], options: dict[str, Any], words: list[str]
) -> None:
    path = tmp_path / "a.csv"
    path.write_text(text(), encoding="utf-8")
    with pytest.raises(Refused) as refused:
        rubnoise.infer(path, speed="1 mm/s", **options)
    assert all(word in str(refused.value) for word in words), refused.value
    if words[0].startswith(("line", "fs")):
        with pytest.raises(Refused) as refused:
            rubnoise.Trace(path, **options)
        assert all(word in str(refused.value) for word in words), refused.value


def test_a_table_of_python_takes_the_options_of_a_file() -> None:
    import pandas as pd

    whole = pd.DataFrame({"time (s)": TIME, "force (mN)": FORCE, "other (V)": TIME})
    part = {"column": "force", "from_": 101, "to": 600}
    trace = rubnoise.Trace(whole, unit="mN", **part)
    found = rubnoise.infer(whole, speed="1 mm/s", law="fixed", unit="mN", **part)
    assert trace["force"].tolist() == (1000.0 * FORCE[100:600]).tolist()
    assert found.signal.scale * found.signal.values == pytest.approx(trace["force"], rel=1e-12)
    alone = pd.DataFrame({"force (mN)": FORCE})
    assert rubnoise.Trace(alone, rate="2500 Hz").step == pytest.approx(4e-4, rel=1e-9)
    assert rubnoise.infer(alone, speed="1 mm/s", law="fixed", rate="2500 Hz").signal.tick == pytest.approx(0.4)
    assert len(rubnoise.Trace(FORCE, rate="2500 Hz", unit="mN", from_="0.04 s", to=600)) == 500
    for read in (rubnoise.Trace, lambda table, **keys: rubnoise.infer(table, speed="1 mm/s", **keys)):
        with pytest.raises(Refused, match="force is in mN by its own words; leave unit= out"):
            read(whole, unit="N", **part)


def test_what_a_dataset_says_of_its_values_is_heeded(tmp_path: Path) -> None:
    packed = np.rint((FORCE - 20.0) / 0.01).astype("i4")
    with h5py.File(tmp_path / "a.h5", "w") as file:
        for name, values, about in (
            ("packed", packed, {"units": "mN", "scale_factor": 0.01, "add_offset": 20.0}),
            ("array", FORCE, {"units": np.array([b"mN"])}),
            ("column", FORCE[:, None], {"units": "mN"}),
            ("latin", 1000.0 * FORCE[None, :], {"units": np.bytes_("µN".encode("latin-1"))}),
            ("Newton", FORCE / 1000.0, {"units": "Newton"}),
            ("filled", SPOILED, {"units": "mN", "_FillValue": -9999.0}),
            ("t", np.arange(FORCE.size) * 400_000, {"units": "nanoseconds since 2024-03-05 09:00:00"}),
        ):
            file[name] = values
            file[name].attrs.update(about)
        file["t"].make_scale("t")
        file["array"].dims[0].attach_scale(file["t"])
    with netcdf_file(tmp_path / "a.nc", "w") as file:
        file.createDimension("time", FORCE.size)
        for name, kind, values, about in (
            ("time", "f8", 1000.0 * TIME, {"units": "ms"}),
            ("force", "i4", packed, {"units": "mN", "scale_factor": 0.01, "add_offset": 20.0}),
        ):
            variable = file.createVariable(name, kind, ("time",))
            variable[:] = values
            for key, value in about.items():
                setattr(variable, key, value)
    rate = {"rate": "2500 Hz"}
    for name, options in (
        *((f"a.h5:/{each}", rate) for each in ("packed", "column", "latin", "Newton")),
        ("a.h5:/array", {}),
        ("a.nc:force", {}),
    ):
        trace = rubnoise.Trace(f"{tmp_path}/{name}", **options)  # type: ignore[arg-type]
        (force,) = [each for each in trace if each != trace.place]
        np.testing.assert_allclose(trace[force], 1000.0 * FORCE, atol=5.1)
        assert (trace.units[force], trace.step) == ("uN", pytest.approx(4e-4))
    for read in (rubnoise.Trace, read_measured):
        with pytest.raises(Refused, match=r"filled\[100\] is its _FillValue, -9999"):
            read(f"{tmp_path}/a.h5:/filled")
