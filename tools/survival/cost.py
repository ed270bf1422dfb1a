"""What safety costs: runs with journal, hashes and commits beside runs without any of it, turn about."""

import gc
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from time import process_time

from rubnoise.api.playing import describe, play
from rubnoise.scenario import Scenario, load
from rubnoise.storage.writer import RunWriter
from survival.stories import NAME, Outcome

FIGURE = Path(__file__).resolve().parents[2] / "scenarios" / "paper" / "fig5.toml"
JUNCTIONS = 1e6
MOST_PER_CENT = 15.0


@dataclass(frozen=True, slots=True)
class Pair:
    """Seconds of the processor's time of a safe run and of the one beside it that is not."""

    safe: float
    bare: float

    @property
    def per_cent(self) -> float:
        """What safety costs of all that the safe run takes."""
        return 100.0 * (self.safe - self.bare) / self.safe


def cost(count: int, _seed: int, junctions: float = JUNCTIONS) -> Outcome:
    """Measure so many pairs of runs of Figure 5 with the batch engine, after one that is not counted."""
    scenario, outcome = of_junctions(junctions), Outcome()
    pairs = [pair(scenario, safe_first=turn % 2 == 0) for turn in range(count + 1)][1:]
    for turn, each in enumerate(pairs):
        print(f"{turn:>3}  safe {each.safe:.3f} s, bare {each.bare:.3f} s, {each.per_cent:5.1f} %", flush=True)
    best = Pair(min(each.safe for each in pairs), min(each.bare for each in pairs))
    middle = median(each.per_cent for each in pairs)
    print(f"best of each: safe {best.safe:.3f} s, bare {best.bare:.3f} s, {best.per_cent:.1f} %; median {middle:.1f} %")
    outcome.count("pairs of runs", count)
    if middle > MOST_PER_CENT:
        outcome.find(f"safety costs {middle:.1f} % of a run")
    return outcome


def of_junctions(junctions: float) -> Scenario:
    """Return Figure 5 with the batch engine, as long as so many junctions take."""
    model = load(FIGURE).model()
    births = model.mean_junction_count / model.mean_life_distance
    return load(FIGURE, ("run.engine=batch", f"sliding.distance={junctions / births:.6g} um"))


def pair(scenario: Scenario, *, safe_first: bool) -> Pair:
    """Make a safe run and one that is not."""
    taken = {safe: _seconds(scenario, safe=safe) for safe in (safe_first, not safe_first)}
    return Pair(taken[True], taken[False])


def _seconds(scenario: Scenario, *, safe: bool) -> float:
    with TemporaryDirectory(prefix="rubnoise-") as folder:
        path = Path(folder) / NAME
        gc.collect()
        began = process_time()
        with RunWriter(path, describe(scenario, path, ["cost"]), safe=safe) as writer:
            play(writer, scenario)
        return process_time() - began
