"""The runs that are interrupted, what must be in their results, and what came of it."""

import json
import math
import sys
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any, Final

import h5py
import xxhash

from rubnoise.errors import RubnoiseError
from survival.child import command


@dataclass(kw_only=True)
class Outcome:
    """Counts of what happened, and a line for each thing that was lost or wrong."""

    counts: Counter[str] = field(default_factory=Counter)
    findings: list[str] = field(default_factory=list)

    def count(self, what: str, number: int = 1) -> None:
        """Count something that happened."""
        self.counts[what] += number

    def find(self, where: str, wrong: Iterable[str]) -> None:
        """Keep what should not be, and print it at once."""
        for what in wrong:
            print(f"{where}: {what}", file=sys.stderr, flush=True)
            self.findings.append(f"{where}: {what}")

    @contextmanager
    def trial(self, where: str) -> Iterator[Path]:
        """Yield a folder for one trial; an error in it is a finding."""
        with TemporaryDirectory(prefix="rubnoise-") as folder:
            try:
                yield Path(folder)
            except RubnoiseError as problem:
                self.find(where, [str(problem)])
            except Exception as problem:  # noqa: BLE001  (whatever it is, it should not be)
                self.find(where, [f"{type(problem).__name__}: {problem}"])

    def add(self, other: "Outcome") -> None:
        """Add the counts and findings of another outcome."""
        self.counts += other.counts
        self.findings += other.findings

    def told(self) -> str:
        """Return all of it as text, most of it counts."""
        width = max(map(len, self.counts), default=0)
        rows = [f"{what:<{width}}  {number:>8,}" for what, number in self.counts.items()]
        return "\n".join([*rows, *(f"- {finding}" for finding in self.findings), f"{len(self.findings)} found"])


NAME: Final = "x.h5"
PART: Final = f"{NAME}.part"
SCENARIO: Final = "x.toml"
OLDER: Final = b"a result of before"

CONTACT: Final = {"interface": {"mean_real_contact_area": "200 um^2", "mean_junction_count": 20}}
SLIDER: Final = {
    "strength": {"mean": "250 MPa"},
    "slider": {"mass": "5 g", "stiffness": "300 N/m", "damping": "0.05 N*s/m"},
}
TWO_WAY: Final = SLIDER | {"slider": SLIDER["slider"] | {"coupling": "two-way"}}
FREE: Final = {
    "interface": {"load": "0.05 N", "hardness": "1 GPa", "mean_junction_count": 0.5},
    "strength": {"mean": "250 MPa"},
    "load": {"height_scale": "5 um", "mass": "5 g", "motion": "free", "restitution": 0.7},
}
ORIGIN: Final = ("scenario_toml", "seed", "stream_version", "propagator_constants")
"""Attributes of /provenance that do not depend on when and where a run was made."""


@dataclass(frozen=True, kw_only=True)
class Story:
    """A run, by the sections that its scenario has beside those of the contact."""

    name: str
    sections: Mapping[str, Any] = field(default_factory=dict, hash=False)
    engine: str = "batch"
    speed: str = "1 mm/s"
    distance: str = "1500 um"
    tick: str = "2 um"
    compression: str = "none"

    @property
    def text(self) -> str:
        """The scenario as a file."""
        sections = {
            **CONTACT,
            **self.sections,
            "sliding": {"distance": self.distance, "speed": self.speed},
            "output": {"tick": self.tick, "compression": self.compression},
            "run": {"engine": self.engine},
        }
        lines = ["format = 1", f"title = {json.dumps(self.name)}"]
        for name, keys in sections.items():
            lines += [f"[{name}]", *(f"{key} = {json.dumps(each)}" for key, each in keys.items())]
        return "\n".join(lines) + "\n"

    @cached_property
    def expected(self) -> Mapping[str, Any]:
        """The content of its result if nothing stops the run, which is made here."""
        with TemporaryDirectory(prefix="rubnoise-") as folder:
            self.write(Path(folder))
            if code := command(self.words(), Path(folder)):
                raise RuntimeError(f"{self.name}: exit code {code}")
            return contents(Path(folder) / NAME)

    def write(self, folder: Path, *, older: bool = False) -> None:
        """Put its scenario into a folder, with a result of before if asked for."""
        (folder / SCENARIO).write_text(self.text, encoding="utf-8")
        if older:
            (folder / NAME).write_bytes(OLDER)

    def words(self, *more: str) -> list[str]:
        """Return the words of the command that makes it."""
        return ["run", SCENARIO, "-o", NAME, "-q", *more]


SMALL: Final = (
    Story(name="events with slider", sections=SLIDER, engine="events"),
    Story(name="contact alone, compressed", compression="gzip"),
    Story(name="two-way", sections=TWO_WAY, distance="600 um"),
    Story(name="free, compressed", sections=FREE, speed="1 m/s", distance="2 mm", tick="20 um", compression="gzip"),
)
"""Runs of few calls; the rows of the last two grow."""

LONG: Final = (
    Story(name="events with slider", sections=SLIDER, engine="events", distance="20 mm", tick="1 um"),
    Story(name="batch with slider", sections=SLIDER, distance="100 mm", tick="0.5 um"),
    Story(name="compressed", compression="gzip", distance="60 mm", tick="1 um"),
    Story(name="two-way", sections=TWO_WAY, distance="20 mm", tick="1 um"),
)
"""Runs that take half a second."""


def chance(seed: int, trial: object) -> Random:
    """Return what decides by chance in one trial, the same ever again."""
    return Random(f"{seed}/{trial}")  # noqa: S311  (no secret)


def contents(path: Path) -> dict[str, Any]:
    """Return the hash of each column, the one that the file says it has, the summary, and where it comes from.

    Read with h5py alone; raises ValueError where a column is not what the file says.
    """
    found: dict[str, Any] = {}
    with h5py.File(path, "r") as file:
        for name in [f"{group}/{column}" for group in file for column in file[group]]:
            there = xxhash.xxh3_128_hexdigest(file[name][:].tobytes())
            if there != (said := file[name].attrs["xxh3_128"].decode()):
                raise ValueError(f"/{name} has the hash {there}, and the file says {said}")
            found[name] = there
        found["summary"] = {name: value.item() for name, value in file["summary"].attrs.items()}
        origin = file["provenance"].attrs
        found["provenance"] = {name: str(origin[name]) for name in ORIGIN} | {"finished": bool(origin["finished"])}
        found["title"] = str(file.attrs["title"])
    return found


def wrong_in(path: Path, expected: Mapping[str, Any]) -> list[str]:
    """Return what is wrong with a result: the names under which it differs, or why it cannot be read."""
    try:
        there = contents(path)
    except (OSError, KeyError, ValueError, RuntimeError) as problem:
        return [f"unreadable: {problem}"]
    names = [name for name in {*there, *expected} - {"summary"} if there.get(name) != expected.get(name)]
    return sorted(names) + ([] if _alike(there["summary"], expected["summary"]) else ["summary"])


def interrupted(folder: Path, story: Story, *, older: bool, left: frozenset[str] = frozenset()) -> Iterator[str]:
    """Yield what is wrong in a folder in which a run was interrupted, and with the same command after that.

    The final name leads to the file of before, to a complete result, or to none; only names in ``left`` may lie beside.
    """
    path = folder / NAME
    beside = {entry.name for entry in folder.iterdir()} - {NAME, SCENARIO} - left
    yield from (f"{name} is left" for name in sorted(beside))
    untouched = older and path.exists() and path.read_bytes() == OLDER
    if older and not path.exists():
        yield "the older result is gone"
    if path.exists() and not untouched:
        yield from (f"under the final name: {wrong}" for wrong in wrong_in(path, story.expected))
    if code := command(story.words("--force"), folder):
        yield f"the same command again: exit code {code}"
    yield from (f"made again: {wrong}" for wrong in wrong_in(path, story.expected))
    yield from (
        f"{entry.name} is left beside a result" for entry in folder.iterdir() if entry.name not in {NAME, SCENARIO}
    )


def _alike(one: Mapping[str, Any], other: Mapping[str, Any]) -> bool:
    return one.keys() == other.keys() and all(_same(one[name], other[name]) for name in one)


def _same(one: object, other: object) -> bool:
    if isinstance(one, float) and isinstance(other, float):
        return math.isclose(one, other, rel_tol=1e-9, abs_tol=1e-300) or (math.isnan(one) and math.isnan(other))
    return one == other
