"""Right runs under `rubnoise compare`, by hand: `python tools/right_runs.py --runs 40 --kind sparse`.

Every run here is one of the program's own, so nothing is wrong with it, and `compare` promises to say so of 999 runs in
1000. This makes so many runs of each case of tools/right_runs.toml, of many kinds of contact, and counts those that
`compare` calls outside. Exit code 1 when there are more than chance explains.
"""

import argparse
import sys
import tomllib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "src")]

from rubnoise.analysis.comparison import compare  # noqa: E402
from rubnoise.analysis.findings import FAMILY_WISE_ERROR, Comparison  # noqa: E402
from rubnoise.model import Model  # noqa: E402
from rubnoise.record.rows import MemoryRecord  # noqa: E402
from rubnoise.scenario import loads  # noqa: E402
from rubnoise.simulation.draws import extent  # noqa: E402
from rubnoise.simulation.run import simulate  # noqa: E402

Cases = dict[str, tuple[str, ...]]

_CASES: Final = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
CONTACT: Final[str] = _CASES["contact"]
KINDS: Final[dict[str, Cases]] = {
    kind: {name: (*(_CASES["slider"] if kind == "sliders" else ()), *changes) for name, changes in cases.items()}
    for kind, cases in _CASES["kinds"].items()
}
CHANCE: Final = 1e-3
"""How improbable a number of alarms may be before the promise is called broken."""

_FAR: Final = 3.0


@dataclass(slots=True)
class Count:
    """What runs came to: alarms by seed, and how many scores there were and how many were far off."""

    runs: int = 0
    alarms: dict[int, list[str]] = field(default_factory=dict)
    scores: int = 0
    far: int = 0

    def add(self, seed: int, found: Comparison) -> None:
        """Take in a run."""
        self.runs += 1
        if found.outside:
            self.alarms[seed] = list(found.outside)
        z = [abs(figure.z) for figure in found.figures if figure.z is not None]
        self.scores += len(z)
        self.far += sum(each > _FAR for each in z)


def model_of(changes: Sequence[str]) -> Model:
    """Return the model of a case."""
    spreads = "diameter.spread=" not in changes and not any('law="exponential"' in each for each in changes)
    text = CONTACT if spreads else CONTACT.replace('spread = "0.2 um"\n', "")
    return loads(text, "a case", [change for change in changes if not change.endswith("=")]).model()


def compared(model: Model, seed: int) -> Comparison:
    """Run a model, and hold its rows against the theory."""
    record = MemoryRecord(extent(model, seed))
    simulate(model, seed, record, engine="batch")
    return compare(model, record)


def counted(changes: Sequence[str], seeds: Iterable[int]) -> Count:
    """Return what the runs of a case come to."""
    model, count = model_of(changes), Count()
    for seed in seeds:
        count.add(seed, compared(model, seed))
    return count


def chance_of(alarms: int, runs: int) -> float:
    """Return how probable so many alarms or more are, where each run has one with the probability promised."""
    from scipy.special import bdtrc

    return float(bdtrc(alarms - 1, runs, FAMILY_WISE_ERROR)) if alarms else 1.0


def main() -> int:
    """Run every case, print a line for each, and tell whether alarms are as rare as promised."""
    parser = argparse.ArgumentParser(description="Right runs under compare: how many are called outside.")
    parser.add_argument("--runs", type=int, default=40, help="runs of each case")
    parser.add_argument("--first", type=int, default=1, help="first seed; each case has seeds of its own")
    parser.add_argument("--kind", choices=[*KINDS, "all"], default="all", help="cases of one kind alone")
    asked = parser.parse_args()
    total = Count()
    # Runs of one seed share their uniforms whatever the contact: each case has seeds of its own.
    for place, (kind, name, changes) in enumerate((k, n, c) for k, cases in KINDS.items() for n, c in cases.items()):
        if asked.kind in {kind, "all"}:
            first = 1_000_003 * (place + 1) + asked.first
            count = counted(changes, range(first, first + asked.runs))
            told = "; ".join(f"seed {seed}: {', '.join(names)}" for seed, names in count.alarms.items())
            figures = round(count.scores / max(count.runs, 1))
            sums = f"{count.runs:5} runs {figures:3} figures {len(count.alarms):3} alarms"
            print(f"{kind:10}{name:34}{sums}  {told}".rstrip(), flush=True)
            total.runs += count.runs
            total.alarms |= count.alarms
            total.scores += count.scores
            total.far += count.far
    print(f"\n{total.scores} scores, {total.far} beyond 3, {0.0027 * total.scores:.0f} by chance")
    chance = chance_of(len(total.alarms), total.runs)
    print(f"\n{len(total.alarms)} alarms in {total.runs} right runs; {FAMILY_WISE_ERROR:.1%} are promised at most")
    print(f"so many or more have a chance of {chance:.2g}")
    return 0 if total.runs and chance > CHANCE else 1


if __name__ == "__main__":
    sys.exit(main())
