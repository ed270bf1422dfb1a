"""Calls written from the habits of numpy, pandas and xarray: what works at first try, and what is refused with help."""

import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import rubnoise

pytestmark = pytest.mark.slow

LINES = Path(__file__).with_name("habits.txt").read_text(encoding="utf-8").splitlines()
HABITS = [line for line in LINES if line and not line.startswith("# ")]
WORKS, REFUSED = ([line for line in HABITS if (" -> " in line) == refused] for refused in (False, True))


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
    figure = desk["run"].plot("acf", size="single", title=False)
    assert np.allclose(figure.get_size_inches() * 25.4, (84.0, 60.0))
    assert not any(axes.get_title(loc="left") or axes.get_title() for axes in figure.axes)
