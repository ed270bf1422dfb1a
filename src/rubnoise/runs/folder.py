"""The folder of a sweep: whose runs are in it, which part of them is a shard's, and whether there is room."""

import json
import os
import re
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Final, Self

from rubnoise.errors import OutputRefused, Refused, RunFileRefused
from rubnoise.runs.point_file import RUNS, name_in, scenario_of
from rubnoise.scenario.points import Point, points_of, run_id
from rubnoise.scenario.scenario import flattened
from rubnoise.scenario.sweep import Sweep, in_words
from rubnoise.storage.forecast import check_sweep_space, expected, together

_SHARD: Final = re.compile(r"([1-9][0-9]{0,5})/([1-9][0-9]{0,5})")
_RUN: Final = re.compile(r"[0-9a-f]{16}(?:\.h5|\.npz)")
_FREE: Final = ("title", "run.engine", "run.seed", "output.tick")
"""Keys that the names of points do not depend on, and the tick, whose default follows from the others."""


def check_folder(root: Path) -> None:
    """Raise OutputRefused if a path is no folder for a sweep: it cannot be written, or holds other files."""
    # A path that may not be looked at counts as missing here: it is the folder above that is closed.
    above = next(place for place in (root, *root.absolute().parents) if os.path.lexists(place))
    if not above.is_dir():
        raise OutputRefused(f"{above}: is no folder")
    if not os.access(above, os.W_OK | os.X_OK):
        raise OutputRefused(f"{above}: the folder is not writable")
    if above != root:
        return
    if not os.access(root, os.R_OK):
        raise OutputRefused(f"{root}: the folder is not readable")
    if not (root / RUNS).is_dir() and any(not entry.name.startswith(".") for entry in root.iterdir()):
        raise OutputRefused(f"{root}: is not a sweep folder, and not empty; name another folder")


def run_files(root: Path) -> Iterator[Path]:
    """Yield the files of runs in the folder of a sweep, in the order of their names."""
    folder = root / RUNS
    if folder.is_dir():
        yield from sorted(path for path in folder.iterdir() if _RUN.fullmatch(path.name))


def check_strangers(root: Path, sweep: Sweep, known: Collection[str]) -> None:
    """Raise OutputRefused if a folder holds the run of a scenario that the sweep lacks; ``known`` are its runs.

    Further replicates of its points are no strangers.
    """
    cases = {run_id(case.scenario): case for case in sweep.cases}
    seed = sweep.cases[0].scenario.run.seed
    replicates: dict[str, set[str]] = {}
    others = [path for path in run_files(root) if path.stem not in known]
    for path in others:
        with suppress(RunFileRefused):  # a damaged one is of no sweep
            resolved = scenario_of(path)
            if (name := name_in(resolved, path, seed)) not in cases:
                raise _stranger(path, _difference(resolved, sweep))
            if name not in replicates:
                more = points_of([cases[name]], len(others) + len(known))
                replicates[name] = {point.run_id for point in more}
            if path.stem not in replicates[name]:
                raise _stranger(path, "its seed is of another run.seed")


def _stranger(path: Path, reason: str) -> OutputRefused:
    where = f"{path.parent.parent}: holds the runs of another scenario"
    return OutputRefused(f"{where}; {path.stem}: {reason}; force=True leaves them beside the runs of this one")


def _difference(resolved: Mapping[str, Any], sweep: Sweep) -> str:
    """Return in what a run differs from all points of a sweep, which differ among themselves in the swept keys."""
    if not resolved:
        return "this version makes other bits of its scenario"
    there = flattened(resolved)
    here = flattened(json.loads(json.dumps(sweep.cases[0].scenario.resolved())))
    for key in sorted((here.keys() | there.keys()) - {*_FREE, *sweep.keys}):
        one, other = there.get(key, "not given"), here.get(key, "not given")
        if one != other:
            return f"{key} is {one} there, and {other} here"
    return f"it is of a point that this sweep lacks: {in_words({key: there.get(key) for key in sweep.keys})}"


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

    def names(self, whole: Iterable[str]) -> set[str]:
        """Return the names in this shard, whatever their order."""
        return set(sorted(whole)[self.number - 1 :: self.count])

    def of_sweep(self, sweep: Sweep) -> Sweep:
        """Return the part of a sweep with a precision: whole points, since the shard decides on them."""
        mine = self.names(run_id(case.scenario) for case in sweep.cases)
        return replace(sweep, cases=tuple(case for case in sweep.cases if run_id(case.scenario) in mine))


def check_room(sweep: Sweep, root: Path, jobs: int, points: Sequence[Point]) -> None:
    """Refuse a sweep if its results do not fit on the disk, or the runs at one time not into memory."""
    counts = Counter(point.scenario.model() for point in points)
    one_of_each = {point.scenario.model(): point.scenario for point in points}
    budget = together((expected(one_of_each[model]), count) for model, count in counts.items())
    if sweep.keep == "summary":
        budget = replace(budget, result_bytes=0, disk_bytes=0)
    check_sweep_space(budget, root, jobs=min(jobs, len(points)))
