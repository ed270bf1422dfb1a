"""Records of the user's own: read, checked, converted, and estimated from as runs are."""

from pathlib import Path

import numpy as np
import pytest
from scipy import signal

import rubnoise
from tests.cli.terminal import call

RNG = np.random.default_rng(11)
VALUES = RNG.normal(size=4000)


def _written(folder: Path, text: str, name: str = "m.csv") -> Path:
    (folder / name).write_text(text, encoding="utf-8")
    return folder / name


@pytest.mark.parametrize(
    ("header", "separator"),
    [("time (ms),velocity (mm/s)", ","), ("time [ms];velocity [mm/s]", ";"), ("time (ms)\tvelocity (mm/s)", "\t")],
)
def test_headers_carry_units_in_several_forms(tmp_path: Path, header: str, separator: str) -> None:
    rows = "\n".join(f"{n / 2}{separator}{n}" for n in range(5))
    trace = rubnoise.Trace.from_csv(_written(tmp_path, f"# a comment\n{header}\n{rows}\n"))
    assert dict(trace.units) == {"time": "s", "velocity": "um/s"}
    assert trace.step == pytest.approx(0.0005)
    np.testing.assert_allclose(trace["velocity"], 1000.0 * np.arange(5))


def test_what_export_writes_is_read(tmp_path: Path) -> None:
    scenario = rubnoise.example("paper/fig5").replace(distance="100 um")
    rubnoise.run(scenario, tmp_path / "x.h5").close()
    assert (
        call("export", str(tmp_path / "x.h5"), "--to", "csv", "--group", "slider", "-o", str(tmp_path / "s.csv")).code
        == 0
    )
    trace = rubnoise.Trace.from_csv(tmp_path / "s.csv")
    with rubnoise.open(tmp_path / "x.h5") as run:
        for name in run.slider:
            assert trace.units[name] == run.slider[name].units
            np.testing.assert_array_equal(trace[name], run.slider[name])


def test_a_decimal_comma_beside_semicolons_and_units_of_others() -> None:
    trace = rubnoise.Trace.from_arrays({"time (s)": [0.0, 1.0, 2.0], "sensor (V)": [1, 2, 3], "force (mN)": [1, 2, 3]})
    assert dict(trace.units) == {"time": "s", "sensor": "V", "force": "uN"}
    assert trace["force"].tolist() == [1000.0, 2000.0, 3000.0]


@pytest.mark.parametrize(
    ("rows", "told"),
    [
        ("0,1\n1,2\n2,x\n", "line 4: v: 'x' is no number"),
        ("0,1\n1,\n2,3\n", "line 3: v: '' is no number"),
        ("0,1\n1,nan\n2,3\n", "line 3: v is nan; every sample needs a number"),
        ("0,1\n1,2,3\n2,3\n", "line 3: 3 cells; there are 2 names"),
        ("0,1\n1,1\n2,1\n5,1\n6,1\n7,1\n", "line 5: time grows by 3 s"),
        ("0,1\n1,1\n1,1\n2,1\n3,1\n", "line 4: time grows by 0 s"),
        ("3,1\n2,1\n1,1\n", "time does not grow"),
        ("0.000,1\n1.000,1\n2.000,1\n3.200,1\n4.000,1\n", r"line 5: time grows by 1\.2 s"),
        ("0,1\n", "1 rows"),
        ("", "no row of numbers"),
    ],
)
def test_what_is_wrong_is_named_with_its_line(tmp_path: Path, rows: str, told: str) -> None:
    path = _written(tmp_path, "time (s),v (mm/s)\n" + rows)
    with pytest.raises(rubnoise.Refused, match=told):
        rubnoise.Trace.from_csv(path)


@pytest.mark.parametrize("header", ["time (s),v (mm^^2)", "time (s),v (s),v (s)"])
def test_wrong_headers_are_refused(tmp_path: Path, header: str) -> None:
    path = _written(tmp_path, f"{header}\n" + "0,1,1\n1,1,1\n" if header.count(",") == 2 else f"{header}\n0,1\n1,1\n")
    with pytest.raises(rubnoise.Refused, match=r"m\.csv"):
        rubnoise.Trace.from_csv(path)


def test_times_rounded_when_they_were_written_are_uniform(tmp_path: Path) -> None:
    rows = "\n".join(f"{n / 30:.3f},{n}" for n in range(200))
    trace = rubnoise.Trace.from_csv(_written(tmp_path, f"time (s),x (um)\n{rows}\n"))
    assert trace.step == pytest.approx(1.0 / 30.0, rel=1e-4)


def test_estimates_are_those_of_scipy_and_numpy() -> None:
    trace = rubnoise.Trace.from_arrays({"time (s)": np.arange(4000) / 100.0, "velocity (m/s)": VALUES})
    _, density = signal.welch(VALUES, fs=100.0, nperseg=200)
    np.testing.assert_allclose(trace.psd(segment="2 s").density[1:-1], density[1:-1], rtol=1e-9)
    lags, away = trace.acf(longest="0.2 s"), VALUES - VALUES.mean()
    direct = [away[: 4000 - lag] @ away[lag:] / 4000 for lag in range(21)]
    np.testing.assert_allclose(1e-12 * lags.covariance, direct, rtol=1e-9, atol=1e-12)
    shares = trace.histogram(bins=20)
    expected, _ = np.histogram(VALUES, 20, density=True)
    np.testing.assert_allclose(1e6 * shares.density, expected, rtol=1e-9)
    assert np.isfinite(shares.standard_error).all()


def test_a_column_or_a_lag_that_there_is_not_is_refused() -> None:
    trace = rubnoise.Trace.from_arrays({"time (s)": [0.0, 1.0, 2.0], "a": [1, 2, 3], "b": [1, 2, 3]})
    with pytest.raises(rubnoise.Refused, match="say which column: a, b"):
        trace.acf()
    with pytest.raises(rubnoise.Refused, match="lags up to 2 s"):
        trace.acf("a", longest="5 s")
    with pytest.raises(rubnoise.Refused, match="segments of 8 rows"):
        trace.psd("a")
    with pytest.raises(KeyError, match="it has time, a, b"):
        trace["c"]


def test_a_record_is_laid_over_a_spectrum_at_its_own_height(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    record = rubnoise.simulate(rubnoise.example("paper/fig5").replace(distance="2 mm"))
    record.save("run.h5").close()
    table = record.slider.to_pandas(["velocity"]) / 1000.0
    table.index.name, table.columns = "time (s)", ["velocity (mm/s)"]
    table.to_csv("measured.csv")
    figure = record.plot("psd", of="velocity", beside=rubnoise.Trace.from_csv("measured.csv"))
    lines = {line.get_label(): line for line in figure.axes[0].get_lines()}
    drawn = next(line for name, line in lines.items() if str(name).startswith("simulated"))
    at = 0.5 * (38.0 + 45.0)
    heights = [float(np.interp(at, line.get_xdata(), line.get_ydata())) for line in (drawn, lines["measured.csv"])]
    # The same record in other segments: within what 12 segments leave open (4 / sqrt(12)), and far from a wrong unit.
    assert 0.2 < heights[1] / heights[0] < 5.0
    done = call("plot", "run.h5", "psd", "--of", "velocity", "--with", "measured.csv", "-o", "over.png")
    assert done.code == 0, done.err
    assert call("plot", "run.h5", "slider", "--with", "measured.csv").code == 2
    wrong = call("plot", "run.h5", "psd", "--of", "displacement", "--with", "measured.csv")
    assert (wrong.code, "needs a column displacement in units of um" in wrong.err) == (2, True)
