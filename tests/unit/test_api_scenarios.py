"""What Python is given: scenarios by path, name or object, and records of the user's own."""

import gc
import pickle
from copy import copy
from pathlib import Path
from typing import Any

import numpy as np
import pint
import pytest
from scipy import signal

import rubnoise
from rubnoise.api.sweep_result import short_names
from rubnoise.errors import Refused
from tests.shell.terminal import call

# Scenarios by path, name or object, and other values of their keys.
UNIT: Any = pint.UnitRegistry()
BASE = rubnoise.example("paper/fig5")


def test_a_scenario_goes_by_path_name_or_itself(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert rubnoise.load("paper/fig5").resolved() == rubnoise.load("paper/fig5.toml").resolved() == BASE.resolved()
    assert rubnoise.load(BASE) is BASE
    assert rubnoise.load(BASE, ["sliding.speed=2 mm/s"]).sliding.speed == 2000.0
    monkeypatch.chdir(tmp_path)
    Path("paper").mkdir()
    Path("paper/fig5").write_text(
        'format = 1\ntitle = "mine"\n[interface]\nmean_real_contact_area = "1 um^2"\n'
        'mean_junction_count = 2\n[sliding]\ndistance = "9 um"\n',
        encoding="utf-8",
    )
    assert rubnoise.load("paper/fig5").title == "mine"
    assert rubnoise.exact("paper/fig4").count_mean == pytest.approx(
        rubnoise.exact(rubnoise.example("paper/fig4")).count_mean
    )


def test_one_key_is_replaced_and_all_else_stays() -> None:
    other = BASE.replace({"sliding.speed": "2 mm/s"}, seed=3)
    expected = BASE.resolved()
    expected["sliding"]["speed"], expected["run"]["seed"] = "2000 um/s", 3
    assert other.resolved() == expected
    assert other.replace({"sliding.speed": "1 mm/s"}, seed=1).resolved() == BASE.resolved()


def test_defaults_follow_what_is_replaced() -> None:
    bare = rubnoise.build(
        {
            "format": 1,
            "interface": {"mean_real_contact_area": 200.0, "mean_junction_count": 20},
            "sliding": {"distance": 50.0},
        }
    )
    larger = bare.replace(mean_real_contact_area="800 um^2")
    assert float(larger.output.tick) == pytest.approx(2.0 * float(bare.output.tick))
    assert BASE.replace(damping_ratio=0.1).slider.damping is None
    two_way = BASE.replace(coupling="two-way")
    assert (two_way.slider.cells, two_way.replace(coupling="one-way").resolved()) == (50, BASE.resolved())
    assert BASE.replace(slider=None).slider is None
    assert BASE.replace(slider={"mass": "6 g"}).slider.mass == 0.006
    assert BASE.replace(seed=8).replace(speed="0.5 mm/s").run.seed == 8


def test_numbers_of_numpy_and_quantities_of_pint_go_where_they_fit() -> None:
    plain = BASE.replace({"sliding.speed": "2 mm/s", "slider.stiffness": "250 N/m", "mean_junction_count": 30})
    fancy = BASE.replace(
        {
            "sliding.speed": UNIT.Quantity(2, "mm/s"),
            "slider.stiffness": 250 * UNIT.N / UNIT.m,
            "mean_junction_count": np.int64(30),
        }
    )
    assert fancy.resolved() == plain.resolved()
    assert BASE.replace(mean_junction_count=UNIT.Quantity(30, "")).interface.mean_junction_count == 30
    assert BASE.replace(distance=UNIT.Quantity(0.1, "inch")).sliding.distance == 2540.0
    assert BASE.replace({"diameter.spread": 4 * UNIT.percent}).diameter.spread.as_text() == "4 %"
    record = rubnoise.simulate(BASE.replace(distance="100 um"), seed=np.int64(3))
    junction = record.junction(np.int32(9))
    place = junction.birth_distance + junction.diameter
    assert junction.area(UNIT.Quantity(place / 1000.0, "mm")) == pytest.approx(junction.area(place), rel=1e-9)
    with pytest.raises(rubnoise.Refused, match="a quantity in um is needed"):
        junction.area(3 * UNIT.kg)


def test_short_names_are_those_that_mean_one_key() -> None:
    assert short_names(["a.x", "b.y"]) == {"a.x": "x", "b.y": "y"}
    assert short_names(["diameter.spread", "strength.spread", "sliding.speed"]) == {"sliding.speed": "speed"}
    assert short_names(["run.seed", "sliding.speed"], {"seed"}) == {"sliding.speed": "speed"}


def test_a_grid_takes_what_numpy_and_pint_have() -> None:
    small = BASE.replace(distance="20 um")
    grid = {"interface.mean_junction_count": np.array([10, 20]), "sliding.speed": [UNIT.Quantity(1, "mm/s")]}
    with rubnoise.sweep(small, grid=grid, replicates=np.int64(2), jobs=1) as sweep:  # type: ignore[arg-type]
        assert [point["interface.mean_junction_count"] for point in sweep.values] == [10, 20]
        assert [point["sliding.speed"] for point in sweep.values] == ["1 mm/s"] * 2
        assert len(sweep.runs["seed"]) == 4


@pytest.mark.slow
def test_a_sweep_without_a_folder_stays_as_long_as_its_process() -> None:
    scenario = rubnoise.load("paper/fig4").replace({"sliding.distance": "100 um"})
    sweep = rubnoise.sweep(scenario, replicates=1, jobs=1)
    folder, name = sweep.path, str(sweep.runs["run_id"][0])
    with pytest.raises(Refused, match="state: holds texts; figures are real_contact_area_mean"):
        sweep.estimates("state")
    with pytest.raises(Refused, match="5: is no quantity of a sweep"):
        sweep.plot(5)  # type: ignore[arg-type]
    same = copy(sweep)
    del sweep
    gc.collect()
    with same.run(name) as run:
        assert len(run.trace) > 0
    pickled = pickle.dumps(same)
    del same, run
    gc.collect()
    with pickle.loads(pickled) as again, again.run(name):  # noqa: S301
        assert again.path == folder


@pytest.mark.slow
def test_keys_of_a_sweep_go_by_their_last_words() -> None:
    small = BASE.replace(distance="20 um")
    grid = {"speed": ["500 um/s", "1 mm/s"], "mean_junction_count": [10, 20]}
    with rubnoise.sweep(small, grid=grid, jobs=1) as sweep:
        assert sweep.keys == ("sliding.speed", "interface.mean_junction_count")
        asked: list[tuple[str, Any]] = [
            ("sliding.speed", "1 mm/s"),
            ("speed", "1000 um/s"),
            ("speed", 1000.0),
            ("speed", np.int64(1000)),
            ("speed", 1 * UNIT.mm / UNIT.s),
        ]
        first, *others = [sweep.ratios("junction_count_mean", key, value) for key, value in asked]
        assert [ratio.value for ratio in first[2:]] == [1.0, 1.0]
        assert all(other == first for other in others)
        assert sweep.ratios("junction_count_mean", "mean_junction_count", 10.0)[0].value == 1.0
        with pytest.raises(ValueError, match=r"no point has sliding\.speed = 2 mm/s"):
            sweep.ratios("junction_count_mean", "speed", "2 mm/s")
        with pytest.raises(KeyError, match=r"length is not swept; swept: sliding\.speed, interface"):
            sweep.ratios("junction_count_mean", "length", 1.0)
        for wrong in ("1 um", "fast", 1 * UNIT.um, None):
            with pytest.raises(rubnoise.Refused, match=r"sliding\.speed: "):
                sweep.ratios("junction_count_mean", "speed", wrong)


def test_a_choice_of_a_sweep_is_found_by_its_word() -> None:
    with rubnoise.sweep(
        BASE.replace(distance="20 um", calibration="exact"), grid={"pulse.shape": ["lens", "triangle"]}, jobs=1
    ) as sweep:
        assert sweep.ratios("real_contact_area_mean", "shape", "lens")[0].value == 1.0
        with pytest.raises(ValueError, match=r"no point has pulse\.shape = 3"):
            sweep.ratios("real_contact_area_mean", "shape", 3)


# Records of the user's own: read, checked, converted, and estimated from as runs are.
RNG = np.random.default_rng(11)
VALUES = RNG.normal(size=4000)


def _written(folder: Path, text: str, name: str = "m.csv") -> Path:
    (folder / name).write_text(text, encoding="utf-8")
    return folder / name


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
    assert repr(trace.where("force > 1.5 mN")).startswith("<python>: 2 rows\n  time    s   1 to 2\n")
    assert trace.force.units == pickle.loads(pickle.dumps(trace)).force.units == "uN"  # noqa: S301  (made here)


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
    np.testing.assert_allclose(lags.lag, np.arange(21) / 100.0, rtol=1e-12)
    shares = trace.histogram(bins=20)
    expected, _ = np.histogram(VALUES, 20, density=True)
    np.testing.assert_allclose(1e6 * shares.density, expected, rtol=1e-9)
    assert np.isfinite(shares.standard_error).all()


@pytest.mark.slow
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
    for of, name in (("velocity", "run.h5"), ("area", Path("run.h5"))):
        assert "run.h5" in record.plot("psd", of=of, beside=name).axes[0].get_legend_handles_labels()[1]
    done = call("plot", "run.h5", "psd", "--of", "velocity", "--with", "measured.csv", "-o", "over.png")
    assert done.code == 0, done.err
    assert call("plot", "run.h5", "slider", "--with", "measured.csv").code == 2
    wrong = call("plot", "run.h5", "psd", "--of", "displacement", "--with", "measured.csv")
    assert (wrong.code, "needs a column displacement in units of um" in wrong.err) == (2, True)
