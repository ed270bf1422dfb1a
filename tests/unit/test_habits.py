"""Calls written from the habits of numpy, pandas and xarray: what works at first try, and what is refused with help."""

import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import rubnoise

pytestmark = pytest.mark.slow

WORKS = """
rubnoise.__version__
rubnoise.Trace("trace.csv")
rubnoise.Trace.from_csv(Path("trace.csv"))
rubnoise.Trace(f, rate="10 kHz", unit="N")
rubnoise.Trace.from_array(f, rate="10 kHz", unit="N")
trace.plot()
trace.to_pandas()
trace.to_xarray()
trace["Friction force"].mean()
trace[0:1000]
trace.psd(segment="0.5 s")
rubnoise.infer(trace, speed="1 mm/s", strokes=True)
rubnoise.infer(df["Friction force (N)"], rate="10 kHz", speed="1 mm/s", unit="N", law="normal")
rubnoise.infer(df, speed="1 mm/s", law="normal")
fit
print(fit)
fit.summary()
fit.estimates["diameter"].value
fit.to_pandas().loc["diameter", "value"]
fit.to_dict()["diameter"]["low"]
fit.plot()
fit.report("fit.html")
fit.save("found.toml")
fit.scenario.replace(seed=1)
rubnoise.simulate(fit.scenario)
rubnoise.simulate("paper/fig4", engine="batch", seed=4)
run.plot()
run.plot("psd", of="friction_force", beside="force.csv")
run.plot("trace", size="84 mm x 60 mm", title=False)
run.psd("force").to_pandas()
run.psd("friction_force").to_xarray()
run.exact.area.std
run.provenance["seed"]
run.scenario
run.trace.friction_force
run.trace["friction_force"].plot()
run.save("mine.h5", force=True)
rubnoise.open(Path("mine.h5"))
sc.to_toml()
sc.save("changed.toml")
rubnoise.load("changed.toml")
sc.replace({"sliding.speed": "2 mm/s"}, seed=3)
sc.replace(speed="2 mm/s")
rubnoise.sweep(sc, grid={"sliding.speed": ["0.5 mm/s", "1 mm/s"]}, replicates=2, jobs=1)
rubnoise.sweep("grid.toml", "folder", jobs=1)
sweep.to_xarray()["displacement_std"].mean("replicate")
sweep.to_pandas().head()
sweep.plot("displacement_std")
len(run.junctions)
run.junctions.where("diameter > 5.5 um")["diameter"].mean()
sc.to_dict()["interface"]["mean_junction_count"]
run.summary[0].z
run.psd("velocity").plot()
trace.acf(longest="10 ms").plot()
sweep.plot("displacement_std", size="single", style="paper")
run.trace.to_pandas().describe()
run.trace["distance"] * 1e-3
run.to_xarray()["trace"]["real_contact_area"].sel(distance=100.0, method="nearest")
run.compare().to_pandas()
rubnoise.exact(sc).autocovariance([0.0, 5.0])
[run.trace["friction_force"].units, run.junctions.to_pandas().attrs["units"]]
run.force.mean() - run["force"].mean()
[run.time[:5], run.displacement[-1], run.count.mean(), run.friction_force.units]
pd.DataFrame(run.junctions).iloc[17]
run.junctions.head().index
run.junctions.iloc[17]
run.junction(17).plot()
run.force.plot(ax=run.plot("trace").axes[0])
run.spectrum("force")
run.plot("spectrum")
run.summary.to_pandas().loc["real_contact_area_mean", "z"]
run.exact.psd([0.1, 1.0])
sc.speed
rubnoise.sweep(sc, speed=["10 mm/s", "20 mm/s"], jobs=1).to_pandas()
rubnoise.run(sc, seed=3).force.mean()
""".strip().splitlines()

REFUSED = """
rubnoise.read_csv("trace.csv") -> rubnoise.Trace("trace.csv")
rubnoise.load(sc.to_toml()) -> format = 1
rubnoise.infer(trace) -> speed="1 mm/s"
rubnoise.infer(f, rate=1e4, speed=1.0, unit="N") -> speed="1 mm/s"
rubnoise.infer(f, rate="10 kHz", unit="N", speed="1 mm/s", zero=True) -> "known"
rubnoise.infer(f, rate="10 kHz", unit="parsec", speed="1 mm/s") -> "0.5 mN"
rubnoise.infer(pd.DataFrame({"a": f, "b": f, "c": f}), speed="1 mm/s") -> column=
sc.replace(speed=2.0) -> "2.0 um/s"
sc.replace({"sliding.speed": "2 mm"}) -> um/s
sc.replace({"sliding.spead": "2 mm/s"}) -> speed
sc.replace(damping_ratio="2 %") -> 0.02
rubnoise.simulate("fig5") -> paper/fig5
rubnoise.simulate("paper/fig5", distance="1 mm") -> .replace(distance='1 mm')
rubnoise.load_scenario("paper/fig5") -> rubnoise.load?
run.trace.columns -> .names
run.junctions[17] -> run.junction(17)
run.junction(-1) -> junctions 0 to
rubnoise.open("paper/fig5") -> rubnoise.simulate
run.plot("spectrums") -> there are
run.to_dataframe() -> run.to_pandas()
run.describe() -> run.summary
run.forse -> force
rubnoise.load("twice.h5") -> rubnoise.open("twice.h5")
run.trace["velocity"] -> run.slider
run.plot("psd", figsize=(3.3, 2.5)) -> size="84 mm x 60 mm"
run.plot("psd", size="tiny") -> size="single"
rubnoise.sweep("paper/fig5", "elsewhere") -> grid=
run.save("twice.h5") -> force
run.psd("forse") -> 'force'
""".strip().splitlines()


@pytest.fixture(scope="module")
def desk(tmp_path_factory):
    """A desk with two strokes of a measured force, a scenario, a run of it, a fit and a sweep."""
    sc = rubnoise.load("paper/fig5").replace({"sliding.distance": "2 mm", "output.tick": "0.2 um"})
    run = rubnoise.simulate(sc.replace(seed=3))
    force = 1e-6 * run.trace["friction_force"][:]
    f = force[:8000]
    folder = tmp_path_factory.mktemp("desk")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        yield _laid(sc, run, force, f)
        shutil.rmtree(folder, ignore_errors=True)


def _laid(sc, run, force, f):
    both = np.concatenate([f, -force[:8000][::-1]])
    rows = np.c_[np.arange(both.size) / 5e3, both]
    np.savetxt("trace.csv", rows, delimiter=",", header="Time (s),Friction force (N)", comments="", fmt="%.9g")
    np.savetxt("force.csv", rows[:8000], delimiter=",", header="time (s),force (N)", comments="", fmt="%.9g")
    grid = '[sweep]\nreplicates = 2\n[sweep.grid]\nsliding.speed = ["0.5 mm/s", "1 mm/s"]\n'
    text = f'format = 1\nextends = "paper/fig5"\n[sliding]\ndistance = "400 um"\n{grid}'
    Path("grid.toml").write_text(text, encoding="utf-8")
    run.save("twice.h5")
    trace = rubnoise.Trace("trace.csv")
    return {
        "rubnoise": rubnoise,
        "Path": Path,
        "pd": pd,
        "f": f,
        "df": pd.DataFrame({"Time (s)": rows[:8000, 0], "Friction force (N)": f}),
        "sc": sc.replace(distance="400 um"),
        "run": run,
        "trace": trace,
        "fit": rubnoise.infer(f, rate="5 kHz", unit="N", speed="1 mm/s", zero="known", law="normal"),
        "sweep": rubnoise.sweep("grid.toml", "swept", jobs=1),
    }


def test_habits_that_work(desk):
    """All of one list, in its order: some read what others wrote."""
    failed = []
    for call in WORKS:
        try:
            eval(call, desk)  # noqa: S307  (the list above)
        except Exception as problem:  # noqa: BLE001
            failed.append(f"{call}: {type(problem).__name__}: {problem}")
    assert failed == []


@pytest.mark.parametrize("line", REFUSED, ids=lambda line: line.partition(" -> ")[0])
def test_habits_that_are_refused_with_the_right_call(desk, line):
    call, _, words = line.partition(" -> ")
    with pytest.raises((rubnoise.RubnoiseError, KeyError, IndexError, AttributeError)) as refused:
        eval(call, desk)  # noqa: S307  (the list above)
    assert words in str(refused.value)


def test_a_scenario_that_was_written_has_the_same_bits(desk, tmp_path):
    changed = desk["sc"].replace(speed="2 mm/s", seed=9)
    assert changed.text == changed.to_toml()
    again = rubnoise.load(changed.save(tmp_path / "again.toml"))
    assert again.model() == changed.model()
    first, second = (rubnoise.simulate(each).slider["displacement"][:] for each in (changed, again))
    assert first.tobytes() == second.tobytes()
    with pytest.raises(rubnoise.Refused, match="force=True"):
        changed.save(tmp_path / "again.toml")


def test_a_picture_has_the_size_of_a_column(desk):
    figure = desk["run"].plot("trace", size="single", title=False)
    assert np.allclose(figure.get_size_inches() * 25.4, (84.0, 60.0))
    assert not any(axes.get_title(loc="left") or axes.get_title() for axes in figure.axes)
