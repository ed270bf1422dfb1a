"""Memory of runs of many kinds, beside their forecasts: `python tools/studies run_cost [--large | --two-way]`.

Each is made in a process of its own, twice, since the first loads everything. Exit code 1 where memory was forecast too
small or more than 1.4 times too large. With ``--large``, a million junctions at once are among them: some minutes and
8 GB of memory. With ``--two-way`` it is runs of a slider that pushes back, from 10 um/s to 1 m/s and from half a
junction to 500: there /slider has to have no more rows than were forecast at most.
"""

import argparse
import json
import subprocess
import sys
import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from rubnoise import run
from rubnoise.scenario import Scenario, load
from rubnoise.simulation.cost import PROGRAM_BYTES
from rubnoise.storage.forecast import counted

ROOT = Path(__file__).resolve().parents[2]
WITH_SLIDER = ROOT / "scenarios" / "paper" / "fig5.toml"
CONTACT_ALONE = ROOT / "scenarios" / "paper" / "fig4.toml"
STATUS = Path("/proc/self/status")
MEMORY_FACTOR = 1.4


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """A run: its mean count, its length and tick in mean lives, and what else is to be set."""

    count: float = 20.0
    lives: float = 3000.0
    ticks_per_life: float = 100.0
    changes: Sequence[str] = ()
    slider: bool = True

    def scenario(self, engine: str) -> Scenario:
        """Return the case as a scenario, of 200 um^2 and sizes that spread by 5 %."""
        life = 2.0 * (3.0 * 200.0 / self.count) ** 0.5
        given = (
            f"run.engine={engine}",
            f"interface.mean_junction_count={self.count}",
            "interface.mean_real_contact_area=200 um^2",
            "interface.calibration=exact",
            "diameter.law=normal",
            "diameter.spread=5 %",
            f"sliding.distance={self.lives * life:.8g} um",
            f"output.tick={life / self.ticks_per_life:.5g} um",
        )
        return load(WITH_SLIDER if self.slider else CONTACT_ALONE, (*given, *self.changes))


_RUNS = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
CASES, LARGE = ({name: Case(**about) for name, about in _RUNS[kind].items()} for kind in ("cases", "large"))
TWO_WAY = {
    f"{speed}, {count:g}": Case(
        count=count,
        lives=lives,
        changes=("slider.coupling=two-way", f"sliding.speed={speed}"),
    )
    for speed in ("10 um/s", "100 um/s", "1 mm/s", "10 mm/s", "100 mm/s", "1 m/s")
    for count, lives in ((0.5, 4000.0), (5.0, 4000.0), (20.0, 3000.0), (100.0, 1000.0), (500.0, 200.0))
}


@dataclass(frozen=True, slots=True, kw_only=True)
class Taken:
    """What a run took and what was forecast: memory of its process in bytes, and rows of /slider over the most."""

    peak: int
    forecast_peak: int
    rows_share: float

    @property
    def within(self) -> bool:
        """Whether both were forecast well enough."""
        return 1.0 <= self.forecast_peak / self.peak <= MEMORY_FACTOR and self.rows_share <= 1.0


def taken(scenario: Scenario) -> Taken:
    """Make a run in this process and return what it took."""
    told = counted(scenario)
    with TemporaryDirectory() as folder:
        path = Path(folder) / "run.h5"
        run(scenario, path).close()
        with run(scenario, path, force=True) as made:
            rows = made.slider["time"].size if told.slider_rows_at_most else 0
    return Taken(
        peak=_peak(),
        forecast_peak=PROGRAM_BYTES + told.working_bytes,
        rows_share=rows / (told.slider_rows_at_most or 1),
    )


def _peak() -> int:
    line = next(line for line in STATUS.read_text(encoding="utf-8").splitlines() if line.startswith("VmHWM"))
    return int(line.split()[1]) * 1024


def _in_a_child(name: str, engine: str) -> Taken:
    words = [sys.executable, str(Path(__file__).parent), "run_cost", "--one", name, engine]
    told = subprocess.run(words, stdout=subprocess.PIPE, check=True).stdout
    return Taken(**json.loads(told))


def measure(cases: Mapping[str, Case]) -> int:
    """Print everything and return the exit code."""
    for name in ("Figure 5", "triangles", "1 mm/s, 20"):
        _in_a_child(name, "batch")  # compiles what has not been compiled yet, which takes memory of its own
    print(f"{'':<26}{'MB':>9}{'told':>9}{'ratio':>7}{'rows':>7}")
    runs = []
    for name in cases:
        for engine in ("events", "batch"):
            each = _in_a_child(name, engine)
            runs.append(each)
            print(
                f"{name:<18}{engine:<8}{each.peak / 1e6:>9.0f}{each.forecast_peak / 1e6:>9.0f}"
                f"{each.forecast_peak / each.peak:>7.2f}{each.rows_share:>7.2f}{'' if each.within else '  outside'}",
                flush=True,
            )
    return 0 if all(each.within for each in runs) else 1


def main() -> int:
    """Do what is asked and return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--large", action="store_true", help="a million junctions at once, too")
    parser.add_argument("--two-way", action="store_true", help="sliders that push back, and no others")
    parser.add_argument("--one", nargs=2, metavar=("CASE", "ENGINE"), help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        name, engine = options.one
        print(json.dumps(asdict(taken((CASES | LARGE | TWO_WAY)[name].scenario(engine)))))
        return 0
    return measure(TWO_WAY if options.two_way else CASES | LARGE if options.large else CASES)
