"""The runs that are interrupted: what is run, how it tells where it is, what its result must be, what came of it."""

import json
import math
import sys
import tomllib
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
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
from rubnoise.errors import RubnoiseError
from rubnoise.model import Model
from rubnoise.scenario import Scenario, build
from rubnoise.simulation import draws
from rubnoise.storage import growing as steps
from rubnoise.storage import writer
from rubnoise.storage.output import OutputPaths
from rubnoise.storage.writer import RunWriter
from survival.child import Tell, command, isolated


@dataclass(kw_only=True)
class Outcome:
    """Counts of what happened, and a line for each thing that was lost or wrong."""

    counts: Counter[str] = field(default_factory=Counter)
    findings: list[str] = field(default_factory=list)

    def count(self, what: str, number: int = 1) -> None:
        """Count something that happened."""
        self.counts[what] += number

    def find(self, where: str, wrong: Iterable[str]) -> None:
        """Keep what should not be, and say so at once."""
        for what in wrong:
            print(f"{where}: {what}", file=sys.stderr, flush=True)
            self.findings.append(f"{where}: {what}")

    @contextmanager
    def trial(self, where: str) -> Iterator[Path]:
        """Yield a folder for one trial; what is raised there was found."""
        with TemporaryDirectory(prefix="rubnoise-") as folder:
            try:
                yield Path(folder)
            except RubnoiseError as problem:
                self.find(where, [str(problem)])
            except Exception as problem:  # noqa: BLE001  (whatever it is, it should not be)
                self.find(where, [f"{type(problem).__name__}: {problem}"])

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
LEFT: Final = frozenset(f".{NAME}.{name}" for name in ("lock", "making"))
"""What a kill may leave beside a whole result, and the next run with this name removes."""

SLIDER: Final = {
    "strength": {"mean": "250 MPa"},
    "slider": {"mass": "5 g", "stiffness": "300 N/m", "damping": "0.05 N*s/m"},
}
_TABLES: Final = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
FAMILY: Final[Mapping[str, Any]] = _TABLES["family"]
"""Members of the family of models, by the tables of a scenario that make one."""

KINDS: Final[Mapping[str, Any]] = {**_TABLES["kinds"], **FAMILY}
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
            sections[table] = {key: value for key, value in merged.items() if value != ""}
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
        return replace(self.scenario, run=replace(self.scenario.run, engine=engine))

    @cached_property
    def expected(self) -> Mapping[str, Any]:
        """What is in the result where nothing stops the run; it is made here."""
        with TemporaryDirectory(prefix="rubnoise-") as folder:
            rubnoise.run(self.scenario, Path(folder) / NAME).close()
            return contents(Path(folder) / NAME)


SMALL: Final = tuple(Story(**keys) for keys in _TABLES["small"])
LONG: Final = tuple(Story(**keys) for keys in _TABLES["long"])
SHORT: Final = tuple(replace(story, distance="20 mm") for story in LONG)
"""Runs that take a quarter of the time of the long ones."""


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
        for name in [f"{group}/{column}" for group in file for column in file[group]]:
            there = xxhash.xxh3_128_hexdigest(file[name][:].tobytes())
            if there != (said := file[name].attrs["xxh3_128"].decode()):
                raise ValueError(f"/{name} has the hash {there}, and the file says {said}")
            found[name] = there
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


def judged(folder: Path, story: Story, *, killed: bool = False) -> list[str]:
    """Return what is wrong with a folder in which a run has ended: its result, or what was left beside it."""
    expected = {NAME, SCENARIO, *(LEFT if killed else ())}
    left = sorted({entry.name for entry in folder.iterdir()} - expected)
    return wrong_in(folder / NAME, story.expected) + [f"{name} is left over" for name in left]


@contextmanager
def committing(seconds: float) -> Iterator[None]:
    """Commit after so many seconds, and after two blocks at most: small runs, too, shall have commits."""
    with patch.object(writer, "COMMIT_SECONDS", seconds), patch.object(draws, "_DRAWN_AT_ONCE", 2000):
        yield


@contextmanager
def telling(tell: Tell, *, seconds: float) -> Iterator[None]:
    """Commit after so many seconds, and report every start, commit and end of a run, with the ticks that are done."""
    enter, commit, publish = RunWriter.__enter__, RunWriter._commit, RunWriter.publish  # noqa: SLF001

    def entering(self: RunWriter) -> RunWriter:
        entered = enter(self)
        tell(f"entered {self.state.ticks if self.state else 0}")
        return entered

    def telling_commit(self: RunWriter, state: Any, **how: Any) -> None:
        commit(self, state, **how)
        tell(f"committed {state.ticks}")

    def publishing(self: RunWriter, *given: Any, **named: Any) -> None:
        tell("publishing 0")
        publish(self, *given, **named)
        tell("published 0")

    told = patch.multiple(RunWriter, __enter__=entering, _commit=telling_commit, publish=publishing)
    with committing(seconds), told:
        yield


def make(scenario: Scenario, path: Path, tell: Tell, *, again: bool, seconds: float) -> None:
    """Make a run that commits after so many seconds; ``again``: by resume, where there is a part file."""
    with telling(tell, seconds=seconds):
        if again and OutputPaths.of(path).part.exists():
            rubnoise.resume(f"{path}.part").close()
        else:
            rubnoise.run(scenario, path).close()


def continued(outcome: Outcome, story: Story, folder: Path, committed: int, *, again: bool) -> Iterator[str]:
    """Resume the run in a folder, and yield what is wrong; ``again``: by resume, where there is a part file."""
    path, told = folder / NAME, ["entered -1"]
    part = OutputPaths.of(path).part.exists()
    if part or not path.exists():
        by_resume = part and (again or path.exists())
        outcome.count(f"continued by {'resume' if by_resume else 'run'}")
        make(story.scenario, path, told.append, again=by_resume, seconds=0.0)
    else:
        outcome.count("whole already")
    entered = [int(line.split()[1]) for line in told if line.startswith("entered")][-1]
    if 0 <= entered < committed:
        yield f"{committed} ticks had been committed, and it continued from {entered}"
    yield from judged(folder, story, killed=True)


def afterwards(folder: Path, story: Story, *, again: bool) -> Iterator[str]:
    """Finish the run by the command line if there is no result yet, or a part beside it; yield what is wrong."""
    part, whole = OutputPaths.of(folder / NAME).part.exists(), (folder / NAME).exists()
    if part or not whole:
        given = ["resume", f"{NAME}.part", "-q"] if part and (again or whole) else words(story)
        ending = isolated(lambda: command(given, folder))
        if ending.code:
            yield f"afterwards exit code {ending.code}: {ending.err}"
    yield from judged(folder, story, killed=True)


def _alike(one: Mapping[str, Any], other: Mapping[str, Any]) -> bool:
    return one.keys() == other.keys() and all(_same(one[name], other[name]) for name in one)


def _same(one: object, other: object) -> bool:
    if isinstance(one, float) and isinstance(other, float):
        return math.isclose(one, other, rel_tol=1e-9, abs_tol=1e-300) or (math.isnan(one) and math.isnan(other))
    return one == other
