"""Single changes of the folder of a sweep: its description, journal, index, and the files of its runs."""

from collections.abc import Callable
from pathlib import Path
from random import Random
from shutil import copy

from fuzz.truth import everything

Names = tuple[str, ...]
FolderChange = Callable[[Path, Random], Names]
"""Changes a folder and returns the names of files, one of which has to be named."""

JOURNAL = "journal/runs.jsonl"


def _runs(folder: Path, random: Random, count: int) -> list[Path]:
    return random.sample(sorted((folder / "runs").glob("*.h5")), count)


def _named(*paths: Path) -> Names:
    return tuple(f"runs/{path.name}" for path in paths)


def _turned(path: Path, random: Random) -> None:
    """Turn a bit; of HDF5 one that says something, since not every byte of such a file does."""
    right = path.read_bytes()
    told = everything(path) if path.suffix == ".h5" else None
    while True:
        raw = bytearray(right)
        raw[random.randrange(len(raw))] ^= 1 << random.randrange(8)
        path.write_bytes(raw)
        try:
            if told is None or everything(path) != told:
                return
        except (OSError, RuntimeError, KeyError, ValueError, TypeError, MemoryError):
            return


def bit_of_description(folder: Path, random: Random) -> Names:
    """Turn a bit of sweep.json."""
    _turned(folder / "sweep.json", random)
    return ("sweep.json",)


def bit_of_journal(folder: Path, random: Random) -> Names:
    """Turn a bit of the journal; a run whose line is lost by it may be named in its place."""
    _turned(folder / JOURNAL, random)
    return (JOURNAL, "index.h5")


def bit_of_index(folder: Path, random: Random) -> Names:
    """Turn a bit of the index."""
    _turned(folder / "index.h5", random)
    return ("index.h5",)


def bit_of_run(folder: Path, random: Random) -> Names:
    """Turn a bit of a run."""
    (run,) = _runs(folder, random, 1)
    _turned(run, random)
    return _named(run)


def runs_exchanged(folder: Path, random: Random) -> Names:
    """Exchange the files of two runs."""
    one, other = _runs(folder, random, 2)
    passing = one.with_suffix(".passing")
    one.rename(passing)
    other.rename(one)
    passing.rename(other)
    return _named(one, other)


def run_over_another(folder: Path, random: Random) -> Names:
    """Copy the file of a run over that of another."""
    one, other = _runs(folder, random, 2)
    copy(one, other)
    return _named(other)


def run_gone(folder: Path, random: Random) -> Names:
    """Remove the file of a run."""
    (run,) = _runs(folder, random, 1)
    run.unlink()
    return _named(run)


def run_renamed(folder: Path, random: Random) -> Names:
    """Give a run another name."""
    (run,) = _runs(folder, random, 1)
    run.rename(renamed := run.with_name(f"{random.randrange(1 << 64):016x}.h5"))
    return _named(run, renamed)


def run_cut_short(folder: Path, random: Random) -> Names:
    """Cut the end off a run."""
    (run,) = _runs(folder, random, 1)
    run.write_bytes(run.read_bytes()[: random.randrange(run.stat().st_size)])
    return _named(run)


def file_among_runs(folder: Path, random: Random) -> Names:
    """Put a file of another kind among the runs."""
    (more := folder / "runs" / f"{random.randrange(1 << 32)}.txt").touch()
    return _named(more)


def file_among_journals(folder: Path, random: Random) -> Names:
    """Put a file of another kind among the journals."""
    (more := folder / "journal" / f"{random.randrange(1 << 32)}.txt").touch()
    return (f"journal/{more.name}",)


def line_gone(folder: Path, random: Random) -> Names:
    """Take out of the journal a line that calls a run done."""
    lines = (folder / JOURNAL).read_text(encoding="utf-8").splitlines(keepends=True)
    lines.remove(random.choice([line for line in lines if '"state":"done"' in line]))
    (folder / JOURNAL).write_text("".join(lines), encoding="utf-8")
    return ("index.h5",)


def index_gone(folder: Path, _random: Random) -> Names:
    """Remove the index."""
    (folder / "index.h5").unlink()
    return ("index.h5",)


def index_cut_short(folder: Path, random: Random) -> Names:
    """Cut the end off the index."""
    index = folder / "index.h5"
    index.write_bytes(index.read_bytes()[: random.randrange(index.stat().st_size)])
    return ("index.h5",)


def description_gone(folder: Path, _random: Random) -> Names:
    """Remove sweep.json."""
    (folder / "sweep.json").unlink()
    return ("sweep.json",)


CHANGES: tuple[FolderChange, ...] = (
    *(bit_of_description, bit_of_journal, bit_of_index, bit_of_run) * 3,
    runs_exchanged,
    run_over_another,
    run_gone,
    run_renamed,
    run_cut_short,
    file_among_runs,
    file_among_journals,
    line_gone,
    index_gone,
    index_cut_short,
    description_gone,
)
