"""The runs that are tortured: what is run, what its result has to be, and what came of it all."""

import json
import math
import sys
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any, Final
from unittest.mock import patch

import h5py
import xxhash

import rubnoise
from rubnoise.model import Model
from rubnoise.scenario import Scenario, build
from rubnoise.storage import growing as steps


@dataclass(kw_only=True)
class Outcome:
    """Counts of what happened, and a line for each thing that was lost or wrong."""

    counts: Counter[str] = field(default_factory=Counter)
    findings: list[str] = field(default_factory=list)

    def count(self, what: str, number: int = 1) -> None:
        """Count something that happened."""
        self.counts[what] += number

    def find(self, what: str) -> None:
        """Keep something that should not be, and say so at once."""
        print(what, file=sys.stderr, flush=True)
        self.findings.append(what)

    def add(self, other: "Outcome") -> None:
        """Take over what another one holds."""
        self.counts += other.counts
        self.findings += other.findings

    def told(self) -> str:
        """Return all of it as text, most of it counts."""
        width = max(map(len, self.counts), default=0)
        rows = [f"{what:<{width}}  {number:>8,}" for what, number in self.counts.items()]
        return "\n".join([*rows, *(f"- {finding}" for finding in self.findings), f"{len(self.findings)} found"])


NAME: Final = "x.h5"
SCENARIO: Final = "x.toml"
SLIDER: Final = {
    "strength": {"mean": "250 MPa"},
    "slider": {"mass": "5 g", "stiffness": "300 N/m", "damping": "0.05 N*s/m"},
}
FAMILY: Final[Mapping[str, Mapping[str, Any]]] = {
    "gamma": {"birth": {"law": "gamma", "shape": 4}},
    "clustered": {"birth": {"law": "clustered", "cluster_size": 3, "cluster_width": "2 um"}},
    "jittered": {"birth": {"law": "jittered", "jitter": "30 %"}},
    "parabolas off the centre line": {"pulse": {"shape": "parabola", "offset": "uniform"}},
    "measured sizes": {"diameter": {"law": "empirical", "values": [3.1, 4.4, 5.0, 8.2], "sampled": "alive"}},
}
"""Members of the family of models, by the tables of a scenario that make one."""
KINDS: Final[Mapping[str, Mapping[str, Any]]] = {
    "two-way": {"slider": {"coupling": "two-way"}},
    "off-centre": {"pulse": {"offset": "uniform"}},
    "under-load": {
        "interface": {"mean_real_contact_area": None, "load": "0.2 N", "hardness": "1 GPa"},
        "load": {"height_scale": "0.5 um", "mass": "5 g", "damping_ratio": 0.05},
    },
    "free": {
        "interface": {
            "mean_real_contact_area": None,
            "load": "0.05 N",
            "hardness": "1 GPa",
            "mean_junction_count": 0.5,
        },
        "strength": {"mean": "250 MPa"},
        "sliding": {"speed": "1 m/s"},
        "load": {"height_scale": "5 um", "mass": "5 g", "motion": "free", "restitution": 0.7},
    },
    **FAMILY,
}
"""Kinds of runs, by the keys of a scenario that make one; None: without that key."""
ORIGIN: Final = ("scenario_toml", "seed", "stream_version", "propagator_constants")
"""Attributes of /provenance that do not depend on when and where a run was made."""


@dataclass(frozen=True, kw_only=True)
class Story:
    """A run of blocks of a thousand junctions, some 550 um long each."""

    name: str
    engine: str = "events"
    slider: bool = True
    kind: str = ""
    compression: str = "none"
    distance: str = "2400 um"
    tick: str = "2 um"
    seed: int = 1

    @property
    def keys(self) -> dict[str, Any]:
        """The scenario as sections of keys."""
        sections: dict[str, Any] = {
            "format": 1,
            "title": self.name,
            "interface": {"mean_real_contact_area": "200 um^2", "mean_junction_count": 20},
            "sliding": {"distance": self.distance, "speed": "1 mm/s"},
            "output": {"tick": self.tick, "compression": self.compression},
            "run": {"engine": self.engine, "seed": self.seed},
        }
        if self.slider:
            sections |= SLIDER
        for table, keys in KINDS.get(self.kind, {}).items():
            merged = {**sections.get(table, {}), **keys}
            sections[table] = {key: value for key, value in merged.items() if value is not None}
        return sections

    @property
    def text(self) -> str:
        """The scenario as a file, long enough to have pages that can be lost."""
        lines = [f"# {self.name}"] * 500
        for name, value in self.keys.items():
            if isinstance(value, dict):
                lines += [f"[{name}]", *(f"{key} = {json.dumps(each)}" for key, each in value.items())]
            else:
                lines.append(f"{name} = {json.dumps(value)}")
        return "\n".join(lines) + "\n"

    @cached_property
    def scenario(self) -> Scenario:
        """What is run."""
        return replace(build(self.keys), text=self.text)

    def by(self, engine: str) -> Scenario:
        """Return what is run, by another engine than the file says."""
        return replace(self.scenario, run=self.scenario.run.model_copy(update={"engine": engine}))

    @cached_property
    def expected(self) -> Mapping[str, Any]:
        """What is in the result where nothing stops the run; it is made here."""
        with TemporaryDirectory(prefix="rubnoise-") as folder:
            rubnoise.run(self.scenario, Path(folder) / NAME).close()
            return contents(Path(folder) / NAME)


SMALL: Final = (
    Story(name="events with slider"),
    Story(name="batch with slider", engine="batch", tick="1 um"),
    Story(name="contact alone", slider=False),
    Story(name="compressed", slider=False, compression="gzip"),
)
"""Runs of five blocks."""

LONG: Final = (
    Story(name="events with slider", distance="40 mm", tick="1 um"),
    Story(name="batch with slider", engine="batch", distance="100 mm", tick="0.5 um"),
    Story(name="contact alone", slider=False, distance="40 mm", tick="1 um"),
    Story(name="compressed", engine="batch", compression="gzip", distance="60 mm", tick="1 um"),
)
"""Runs that take half a second, or a second and a half where others want the processors too."""

SHORT: Final = tuple(replace(story, distance="20 mm") for story in LONG)
"""Runs that take a quarter of that."""


def of_kind(kind: str, stories: Sequence[Story]) -> tuple[Story, ...]:
    """Return the runs of another kind: of the family with each member in turn, two-way those alone with a slider."""
    if kind == "family":
        return tuple(each for story in stories for member in FAMILY for each in of_kind(member, [story]))
    found = [story for story in stories if story.slider or kind != "two-way"]
    if kind == "free":  # has fewer junctions
        found = [replace(story, distance=_ten_times(story.distance), tick=_ten_times(story.tick)) for story in found]
    return tuple(replace(story, name=f"{story.name}, {kind}", kind=kind) for story in found)


def _ten_times(length: str) -> str:
    number, unit = length.split()
    return f"{10.0 * float(number):g} {unit}"


@contextmanager
def growing(stories: Sequence[Story] = (*SMALL, *LONG)) -> Iterator[None]:
    """Hide how many rows of /slider there will be, so that they grow beside the part, in short steps.

    What is expected of a story is asked before: the result of a run whose rows were counted.
    """
    for story in stories:
        _ = story.expected
    with patch.object(Model, "slider_rows", None), patch.object(steps, "STEP_BYTES", 1 << 13):
        yield


def chance(seed: int, trial: object) -> Random:
    """Return what decides by chance in one trial, the same ever again."""
    return Random(f"{seed}/{trial}")  # noqa: S311  (no secret)


def contents(path: Path) -> dict[str, Any]:
    """Return the hash of each column, the one that the file says it has, the summary, and where it comes from.

    Read with h5py alone; raises ValueError where a column is not what the file says.
    """
    found: dict[str, Any] = {}
    with h5py.File(path, "r") as file:
        for group, column in _columns(file):
            there = xxhash.xxh3_128_hexdigest(file[group][column][:].tobytes())
            if there != (said := file[group][column].attrs["xxh3_128"].decode()):
                raise ValueError(f"/{group}/{column} has the hash {there}, and the file says {said}")
            found[f"{group}/{column}"] = there
        found["summary"] = {name: value.item() for name, value in file["summary"].attrs.items()}
        origin = file["provenance"].attrs
        found["provenance"] = {name: str(origin[name]) for name in ORIGIN} | {"finished": bool(origin["finished"])}
        found["scenario"] = json.loads(origin["scenario_resolved"])
        found["scenario"]["run"].pop("engine")  # by which it was begun, which changes no bit
        found["title"] = str(file.attrs["title"])
    return found


def differences(there: Mapping[str, Any], expected: Mapping[str, Any]) -> list[str]:
    """Return the names under which two contents differ; figures of the summary may by the order of their sums."""
    names = [name for name in {*there, *expected} - {"summary"} if there.get(name) != expected.get(name)]
    return sorted(names) + ([] if _alike(there["summary"], expected["summary"]) else ["summary"])


def wrong_in(path: Path, expected: Mapping[str, Any]) -> list[str]:
    """Return what is wrong with a result: the names under which it differs, or why it cannot be read."""
    try:
        return differences(contents(path), expected)
    except (OSError, KeyError, ValueError, RuntimeError) as problem:
        return [f"unreadable: {problem}"]


def words(story: Story, *more: str) -> list[str]:
    """Return the words of a run of a story whose scenario lies in the folder."""
    return ["run", SCENARIO, "-o", NAME, "-q", "--set", f"run.engine={story.engine}", *more]


def judged(folder: Path, story: Story, others: Callable[[str], bool] = lambda _: False) -> list[str]:
    """Return what is wrong with a folder in which the run has ended: its result, or what was left beside it."""
    wrong = wrong_in(folder / NAME, story.expected)
    left = [entry.name for entry in folder.iterdir() if entry.name != NAME and not others(entry.name)]
    return wrong + [f"{name} is left over" for name in sorted(left)]


def _columns(file: h5py.File) -> list[tuple[str, str]]:
    return [(group, column) for group in file for column in file[group]]


def _alike(one: Mapping[str, Any], other: Mapping[str, Any]) -> bool:
    return one.keys() == other.keys() and all(_same(one[name], other[name]) for name in one)


def _same(one: object, other: object) -> bool:
    if isinstance(one, float) and isinstance(other, float):
        return math.isclose(one, other, rel_tol=1e-9, abs_tol=1e-300) or (math.isnan(one) and math.isnan(other))
    return one == other
