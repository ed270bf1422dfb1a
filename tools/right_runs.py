"""Right runs under `rubnoise compare`, by hand: `python tools/right_runs.py --runs 40 --kind sparse`.

Every run here is one of the program's own, so nothing is wrong with it, and `compare` promises to say so of 999 runs in
1000. This makes so many runs of each case, of many kinds of contact, and counts those that `compare` calls outside.
Exit code 1 when there are more than chance explains.
"""

import argparse
import re
import sys
from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT), str(ROOT / "src")]

from rubnoise.analysis.agreement import FAMILY_WISE_ERROR  # noqa: E402
from rubnoise.analysis.comparing.findings import Comparison  # noqa: E402
from rubnoise.analysis.comparison import compare  # noqa: E402
from rubnoise.model import Model  # noqa: E402
from rubnoise.record.memory import MemoryRecord  # noqa: E402
from rubnoise.scenario import loads  # noqa: E402
from rubnoise.simulation.extent import extent  # noqa: E402
from rubnoise.simulation.run import simulate  # noqa: E402

Cases = dict[str, tuple[str, ...]]

CONTACT: Final = """
format = 1
[interface]
mean_real_contact_area = "200 um^2"
mean_junction_count = 20
calibration = "paper"
[diameter]
law = "normal"
spread = "0.2 um"
[sliding]
distance = "5 mm"
[output]
tick = "0.2 um"
"""
SLIDER: Final = (
    'strength.mean="250 MPa"',
    'sliding.speed="1 mm/s"',
    'sliding.distance="20 mm"',
    'slider.mass="5 g"',
    'slider.stiffness="300 N/m"',
    'slider.damping="0.05 N*s/m"',
)
SPARSE: Final[Cases] = {
    f"{count:g} over {distance}": (
        f"interface.mean_junction_count={count}",
        f'sliding.distance="{distance}"',
        'output.tick="10 um"',
    )
    for count, distance in (
        (0.05, "6 m"),
        (0.05, "12 m"),
        (0.1, "2 m"),
        (0.1, "5 m"),
        (0.2, "600 mm"),
        (0.2, "2 m"),
        (0.5, "200 mm"),
        (0.5, "1 m"),
        (1, "100 mm"),
        (1, "500 mm"),
    )
}


def _sizes(law: str, spread: str, *more: str) -> tuple[str, ...]:
    exact = ('interface.calibration="exact"', f'diameter.law="{law}"')
    return (*exact, *([f'diameter.spread="{spread}"'] if spread else []), *more)


DENSE: Final[Cases] = {
    "as in the paper": (),
    "one size": ('diameter.law="fixed"', "diameter.spread="),
    "exact": ('interface.calibration="exact"',),
    "matched, 30 %": ('interface.calibration="matched"', 'diameter.spread="30 %"'),
    "long": ('sliding.distance="100 mm"', 'output.tick="1 um"'),
    "fine ticks": ('sliding.distance="1 mm"', 'output.tick="0.01 um"'),
    "wide ticks": ('sliding.distance="20 mm"', 'output.tick="4 um"'),
    "few": ("interface.mean_junction_count=3", 'sliding.distance="20 mm"', 'output.tick="0.5 um"'),
    "many": ("interface.mean_junction_count=300", 'sliding.distance="2 mm"', 'output.tick="0.05 um"'),
    "large": ('interface.mean_real_contact_area="1 mm^2"', 'sliding.distance="1 m"', 'output.tick="20 um"'),
}
SIZES: Final[Cases] = {
    "normal 20 %": _sizes("normal", "20 %"),
    "normal 100 %": _sizes("normal", "100 %", 'sliding.distance="20 mm"'),
    "lognormal 30 %": _sizes("lognormal", "30 %", 'sliding.distance="20 mm"'),
    "lognormal 70 %": _sizes("lognormal", "70 %", 'sliding.distance="50 mm"', 'output.tick="0.5 um"'),
    "exponential": _sizes("exponential", "", 'sliding.distance="50 mm"', 'output.tick="0.5 um"'),
    "gamma 50 %": _sizes("gamma", "50 %", 'sliding.distance="50 mm"', 'output.tick="0.5 um"'),
    "few, lognormal 50 %": _sizes(
        "lognormal", "50 %", "interface.mean_junction_count=2", 'sliding.distance="100 mm"', 'output.tick="1 um"'
    ),
    "0.2, lognormal 50 %": _sizes(
        "lognormal", "50 %", "interface.mean_junction_count=0.2", 'sliding.distance="1 m"', 'output.tick="5 um"'
    ),
}
STRENGTHS: Final[Cases] = {
    f"strengths {law} {spread}": ('strength.mean="250 MPa"', f'strength.law="{law}"', f'strength.spread="{spread}"')
    for law, spread in (("normal", "20 %"), ("lognormal", "40 %"), ("weibull", "60 %"))
}
BIRTHS: Final[Cases] = {
    "regular births": ('birth.law="regular"',),
    "regular births, 20 %": ('birth.law="regular"', 'diameter.spread="20 %"', 'interface.calibration="exact"'),
    "regular births, empty start": ('birth.law="regular"', 'sliding.start="empty"'),
    "regular births, sparse": (
        'birth.law="regular"', "interface.mean_junction_count=0.3", 'sliding.distance="400 mm"', 'output.tick="5 um"',
    ),
}  # fmt: skip
PULSES: Final[Cases] = {
    "triangles": ('pulse.shape="triangle"', 'interface.calibration="exact"'),
    "triangles of one size": (
        'pulse.shape="triangle"', 'interface.calibration="exact"', 'diameter.law="fixed"', "diameter.spread=",
    ),
    "triangles, sparse": (
        'pulse.shape="triangle"', 'interface.calibration="exact"', "interface.mean_junction_count=0.2",
        'sliding.distance="1 m"', 'output.tick="5 um"',
    ),
    "triangles, regular births": (
        'pulse.shape="triangle"', 'interface.calibration="exact"', 'diameter.spread="20 %"', 'birth.law="regular"',
    ),
}  # fmt: skip
STARTS: Final[Cases] = {
    "empty start": ('sliding.start="empty"',),
    "empty start, exponential": _sizes(
        "exponential", "", 'sliding.distance="50 mm"', 'output.tick="0.5 um"', 'sliding.start="empty"'
    ),
    "empty start, sparse": (
        'sliding.start="empty"', "interface.mean_junction_count=0.1", 'sliding.distance="2 m"', 'output.tick="10 um"',
    ),
}  # fmt: skip
SLIDERS: Final[Cases] = {
    "slider": SLIDER,
    "slider from rest": (*SLIDER, 'slider.start="rest"'),
    "slider, over-damped": (*SLIDER, 'slider.damping="5 N*s/m"'),
    "slider, stiff": (*SLIDER, 'slider.stiffness="30000 N/m"', 'slider.damping="0.5 N*s/m"'),
    "slider, fast": (*SLIDER, 'sliding.speed="10 mm/s"', 'sliding.distance="200 mm"', 'output.tick="1 um"'),
    "slider, slow": (*SLIDER, 'sliding.speed="0.1 mm/s"', 'sliding.distance="5 mm"'),
    "slider, strengths lognormal 40 %": (*SLIDER, 'strength.law="lognormal"', 'strength.spread="40 %"'),
    "slider, sparse": (
        *SLIDER, "interface.mean_junction_count=0.5", 'sliding.distance="400 mm"', 'output.tick="5 um"',
        'sliding.speed="20 mm/s"',
    ),
}  # fmt: skip
KINDS: Final[dict[str, Cases]] = {
    "sparse": SPARSE,
    "dense": DENSE,
    "sizes": SIZES,
    "strengths": STRENGTHS,
    "births": BIRTHS,
    "pulses": PULSES,
    "starts": STARTS,
    "sliders": SLIDERS,
}
CHANCE: Final = 1e-3
"""How improbable a number of alarms may be before the promise is called broken."""

_FAR: Final = 3.0
_PLACE: Final = re.compile(r"(_[0-9][0-9.e+-]*)(_to_[0-9.e+-]+)?$")


@dataclass(slots=True)
class Count:
    """What runs came to: alarms by seed, and by figure how many scores there were and how many were far off."""

    runs: int = 0
    alarms: dict[int, list[str]] = field(default_factory=dict)
    scores: Counter[str] = field(default_factory=Counter)
    far: Counter[str] = field(default_factory=Counter)

    def add(self, seed: int, found: Comparison) -> None:
        """Take in a run."""
        self.runs += 1
        if found.outside:
            self.alarms[seed] = list(found.outside)
        for figure in found.figures:
            if figure.z is not None:
                name = _PLACE.sub("", figure.name)
                self.scores[name] += 1
                self.far[name] += abs(figure.z) > _FAR


def model_of(changes: Sequence[str]) -> Model:
    """Return the model of a case."""
    text = CONTACT
    if "diameter.spread=" in changes:
        text = text.replace('spread = "0.2 um"\n', "")
    if any('law="exponential"' in change for change in changes):
        text = text.replace('spread = "0.2 um"\n', "")
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
            figures = round(sum(count.scores.values()) / max(count.runs, 1))
            sums = f"{count.runs:5} runs {figures:3} figures {len(count.alarms):3} alarms"
            print(f"{kind:10}{name:34}{sums}  {told}".rstrip(), flush=True)
            total.runs += count.runs
            total.alarms |= count.alarms
            total.scores += count.scores
            total.far += count.far
    print(f"\n{'figure':40}{'scores':>8}{'|z| > 3':>9}{'by chance':>11}")
    for name, number in total.scores.items():
        print(f"{name:40}{number:8}{total.far[name]:9}{0.0027 * number:11.1f}")
    chance = chance_of(len(total.alarms), total.runs)
    print(f"\n{len(total.alarms)} alarms in {total.runs} right runs; {FAMILY_WISE_ERROR:.1%} are promised at most")
    print(f"so many or more have a chance of {chance:.2g}")
    return 0 if total.runs and chance > CHANCE else 1


if __name__ == "__main__":
    sys.exit(main())
