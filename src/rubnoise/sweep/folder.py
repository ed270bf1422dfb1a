"""The folder of a sweep: the names of its files, the sweep that it belongs to, and the locks of its writers."""

import json
import os
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final, Self

from rubnoise.errors import OutputRefused, Refused, ScenarioRefused
from rubnoise.regular_file import read_at_most
from rubnoise.scenario import build
from rubnoise.scenario.points import Case, Point, run_id
from rubnoise.scenario.reading import ReadSizes, stored_sizes
from rubnoise.scenario.reread import sweep_as_made
from rubnoise.scenario.scenario import flattened
from rubnoise.scenario.sweep import Sweep, in_words
from rubnoise.storage import lock
from rubnoise.storage.output import reason_of, whole_file
from rubnoise.streams import STREAM_VERSION
from rubnoise.sweep.journal import JournalEntry, Stamp, entries

FORMAT: Final = "rubnoise-sweep"
FORMAT_VERSION: Final = 1

_FREE: Final = ("title", "run.engine")
"""Keys that may change, since the names of runs do not depend on them."""


def identity(sweep: Sweep) -> dict[str, Any]:
    """Return the identity of a sweep as plain data: its points by name, and the whole scenario of the first.

    It has the values of every swept file of diameters.
    """
    files = {str(path): case.scenario for case in sweep.cases if (path := _file_of(case.values))}
    sizes = [{_SIZES: scenario.resolved()[_SIZES]} for scenario in files.values()]
    return ({"sizes": sizes} if sizes else {}) | {
        "format": FORMAT,
        "format_version": FORMAT_VERSION,
        "title": sweep.title,
        "keys": list(sweep.keys),
        "keep": sweep.keep,
        "stream_version": STREAM_VERSION,
        "points": [{"values": dict(case.values), "name": run_id(case.scenario)} for case in sweep.cases],
        "first": sweep.cases[0].scenario.resolved(),
    }


_SIZES: Final = "diameter"


def _file_of(values: Mapping[str, Any]) -> tuple[Any, ...]:
    """Return the swept file of diameters and column, empty if neither is swept."""
    return tuple(values[key] for key in (f"{_SIZES}.file", f"{_SIZES}.column") if key in values)


def manifest_text(manifest: Mapping[str, Any]) -> str:
    """Return the text of sweep.json."""
    return f"{json.dumps(manifest)}\n"


def cases_of(kept: Mapping[str, Any]) -> tuple[Case | None, ...]:
    """Return the points of a sweep from its stored description, by name; None for a point whose name does not fit.

    A tick that the file did not give follows from the other keys at each point, so it is not taken from the first one.
    """
    read = stored_sizes(*kept.get("sizes", []))
    return tuple(_case(kept["first"], point["values"], point["name"], read) for point in kept["points"])


def _case(first: Mapping[str, Any], values: Mapping[str, Any], name: str, read: ReadSizes) -> Case | None:
    tables = {section: dict(table) if isinstance(table, Mapping) else table for section, table in first.items()}
    for key, value in values.items():
        section, _, inner = key.partition(".")
        tables.setdefault(section, {})[inner] = value
    if _file_of(values):
        tables[_SIZES] = {key: value for key, value in tables[_SIZES].items() if key not in ("values", "hash")}
    without_tick = {**tables, "output": {key: value for key, value in tables["output"].items() if key != "tick"}}
    for each in (tables, without_tick):
        with suppress(ScenarioRefused):
            scenario = build(each, read=read)
            if run_id(scenario) == name:
                return Case(values=values, scenario=scenario)
    return None


def difference(kept: Mapping[str, Any], sweep: Sweep) -> str | None:
    """Return the difference between a sweep and the stored one, or None if it continues that one.

    It may have more points and other replicates: seeds do not depend on either.
    """
    if kept["stream_version"] != STREAM_VERSION:
        return f"its random streams are of version {kept['stream_version']}, and those of today of {STREAM_VERSION}"
    if kept["keep"] != sweep.keep:
        return f'sweep.keep is "{kept["keep"]}" there, and "{sweep.keep}" here'
    there = {run_id(case.scenario) for case in sweep.cases}
    gone = [point for point in kept["points"] if point["name"] not in there]
    if not gone:
        return None
    changed = next(_changes(kept, sweep), None)
    if changed is not None:
        return changed
    more = f", and {len(gone) - 1:,} more" if len(gone) > 1 else ""
    return f"it has a point that this one lacks: {in_words(gone[0]['values']) or 'no key swept'}{more}"


def _changes(kept: Mapping[str, Any], sweep: Sweep) -> Iterator[str]:
    """Yield the keys outside of the swept ones in which the scenarios differ."""
    values = kept["points"][0]["values"]
    same = next((case for case in sweep.cases if dict(case.values) == values), sweep.cases[0])
    before, now = flattened(kept["first"]), flattened(json.loads(json.dumps(same.scenario.resolved())))
    swept = {*kept["keys"], *sweep.keys, *_FREE}
    # The tick comes last, since without one in the file it follows from the others.
    for key in sorted(before.keys() | now.keys(), key=lambda key: (key == "output.tick", key)):
        if key not in swept and before.get(key) != now.get(key):
            yield f"{key} is {_or_not_given(before.get(key))} there, and {_or_not_given(now.get(key))} here"


def _or_not_given(value: Any) -> str:
    return "not given" if value is None else str(value)


MANIFEST_BYTES: Final = 1 << 26
"""Of the largest sweep, of 10 000 points with a few swept keys each, it takes some MB."""

_SHARD: Final = re.compile(r"([1-9][0-9]{0,5})/([1-9][0-9]{0,5})")


@dataclass(frozen=True, slots=True, kw_only=True)
class Shard:
    """One of several parts of a sweep, numbered from 1, for processes that do not communicate."""

    number: int
    count: int

    @classmethod
    def of(cls, text: str) -> Self:
        """Return the shard that a text such as `2/8` names; raises Refused."""
        found = _SHARD.fullmatch(text)
        if found is None or int(found[1]) > int(found[2]):
            raise Refused(f'shard=: "{text[:20]}" is no part of a whole; right form: shard="2/8", from 1/8 to 8/8')
        return cls(number=int(found[1]), count=int(found[2]))

    def of_points(self, points: Sequence[Point], whole: Sequence[Point]) -> tuple[Point, ...]:
        """Return the points of this shard: by the names of their runs, whatever their order."""
        mine = self._share(point.run_id for point in whole)
        return tuple(point for point in points if point.run_id in mine)

    def of_cases(self, cases: Sequence[Case]) -> tuple[Case, ...]:
        """Return the points of this shard, each with all of its replicates; there may be none."""
        mine = self._share(run_id(case.scenario) for case in cases)
        return tuple(case for case in cases if run_id(case.scenario) in mine)

    def _share(self, names: Iterable[str]) -> set[str]:
        return set(sorted(names)[self.number - 1 :: self.count])


@dataclass(frozen=True, slots=True)
class SweepFolder:
    """The folder of a sweep, with its file names and locks."""

    root: Path

    @property
    def index(self) -> Path:
        """The file that readers open."""
        return self.root / "index.h5"

    @property
    def merged(self) -> Path:
        """The file with everything, made by `merge`."""
        return self.root / "merged.h5"

    def run(self, run_id: str) -> Path:
        """Return the path of the result of a run."""
        return self.root / self.relative(run_id)

    def relative(self, run_id: str) -> str:
        """Return the path of the result relative to the folder."""
        return f"runs/{run_id}.h5"

    def stamp(self, run_id: str) -> Stamp | None:
        """Return a stamp that recognises the file of a run without reading it; None if there is no file."""
        try:
            about = self.run(run_id).stat()
        except OSError:
            return None
        return about.st_size, about.st_mtime_ns

    def holds(self, entry: JournalEntry) -> bool:
        """Whether a run that is done needs no further look: it keeps no file, or its file is the one written then."""
        row = entry.row
        return row is not None and (not row.file or entry.stamp == self.stamp(row.run_id) is not None)

    def journal(self, shard: Shard | None) -> Path:
        """Return the journal of a shard, or of the whole sweep."""
        part = "" if shard is None else f"-{shard.number}-of-{shard.count}"
        return self.root / "journal" / f"runs{part}.jsonl"

    def journals(self) -> list[Path]:
        """Return all journals, in the order in which they are read."""
        return sorted((self.root / "journal").glob("runs*.jsonl"))

    def entries(self) -> Iterator[JournalEntry]:
        """Yield the entries of all journals; of two entries for one run, the one that says done counts."""
        for path in self.journals():
            try:
                yield from entries(path)
            except OSError as problem:
                raise OutputRefused(f"{path}: {reason_of(problem).lower()}") from problem

    def is_at_work(self) -> bool:
        """Whether a process is carrying out the sweep, or a shard of it; asking creates nothing."""
        return any(map(lock.is_held, [self.root / ".sweep.lock", *self.root.glob(".shard-*.lock")]))

    def claim(self, sweep: Sweep) -> Sweep:
        """Make this the folder of a sweep, or check that it is, and return the sweep as stored in the folder.

        Raises OutputRefused with the difference.
        """
        for name in ("runs", "journal"):
            (self.root / name).mkdir(exist_ok=True)
        # Shards that begin at the same moment all write the same, one after another.
        with self.alone_at("claim"):
            kept = self._identity()
            if kept is not None:
                sweep, differs = self._compared(kept, sweep)
                if differs is not None:
                    raise OutputRefused(f"{self.root}: is the folder of another sweep: {differs}")
            wanted = manifest_text(identity(sweep))
            if kept != json.loads(wanted):
                with whole_file(self.manifest, force=True) as part:
                    part.write_text(wanted, encoding="utf-8")
        return sweep

    @property
    def manifest(self) -> Path:
        """The file that describes the sweep of the folder."""
        return self.root / "sweep.json"

    def _identity(self) -> dict[str, Any] | None:
        try:
            kept: Any = json.loads(read_at_most(self.manifest, MANIFEST_BYTES))
        except FileNotFoundError:
            return None
        except OSError as problem:
            raise OutputRefused(f"{self.manifest}: cannot be read: {reason_of(problem).lower()}") from problem
        except (ValueError, RecursionError) as problem:
            raise OutputRefused(f"{self.manifest}: cannot be read: {problem}") from problem
        if not isinstance(kept, dict) or kept.get("format") != FORMAT:
            raise OutputRefused(f"{self.manifest}: is not a file of rubnoise")
        if kept.get("format_version") != FORMAT_VERSION:
            raise OutputRefused(f"{self.manifest}: is of format version {kept.get('format_version')}, not 1")
        return dict(kept)

    def _compared(self, kept: dict[str, Any], sweep: Sweep) -> tuple[Sweep, str | None]:
        try:
            sweep = sweep_as_made(sweep, kept["first"])
            return sweep, difference(kept, sweep)
        except (LookupError, TypeError, AttributeError) as problem:
            raise OutputRefused(f"{self.manifest}: does not say of which sweep the folder is") from problem

    def check(self) -> None:
        """Raise OutputRefused if the path is not a sweep folder: it is no folder, or holds other files."""
        # A path that may not be looked at counts as missing here: it is the folder above that is closed.
        above = next(place for place in (self.root, *self.root.absolute().parents) if os.path.lexists(place))
        if not above.is_dir():
            raise OutputRefused(f"{above}: is no folder")
        if not os.access(above, os.W_OK | os.X_OK):
            raise OutputRefused(f"{above}: the folder is not writable")
        if above == self.root and not os.access(above, os.R_OK):
            raise OutputRefused(f"{above}: the folder is not readable")
        if above == self.root and not self.manifest.exists():
            # A sweep that is stopped before it has written its description leaves these.
            # Another shard may be writing the description at this moment.
            own = {"runs", "journal", self.manifest.name, f"{self.manifest.name}.part"}
            if any(entry.name not in own and not entry.name.endswith(".lock") for entry in self.root.iterdir()):
                raise OutputRefused(f"{self.root}: is not a sweep folder, and not empty; name another folder")

    @contextmanager
    def alone_at(self, what: str) -> Iterator[None]:
        """Lock one file of the folder; wait for a process that holds it."""
        with _locked(self.root / f".{what}.lock", patience=None):
            yield

    @contextmanager
    def writing(self, shard: Shard | None) -> Iterator[None]:
        """Hold the folder: alone, or shared with other shards; raises OutputRefused if others hold it.

        Makes the folder if there is none.
        """
        try:
            self.root.mkdir(parents=True, exist_ok=True)
            with _locked(self.root / ".sweep.lock", shared=shard is not None):
                if shard is None:
                    yield
                else:
                    with _locked(self.root / f".shard-{shard.number}-of-{shard.count}.lock"):
                        yield
        except lock.Held as busy:
            raise OutputRefused(f"{self.root}: another process is running this sweep") from busy


@contextmanager
def _locked(path: Path, *, shared: bool = False, patience: float | None = lock.PATIENCE_SECONDS) -> Iterator[None]:
    """Hold a lock of the folder; raises lock.Held, and OutputRefused if it cannot be made."""
    with ExitStack() as held:
        try:
            held.enter_context(lock.holding(path, shared=shared, patience=patience))
        except OSError as problem:
            raise OutputRefused(f"{path.parent}: cannot be locked: {problem.strerror}") from problem
        yield
