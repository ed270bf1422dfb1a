"""The scenario files that come with rubnoise: of the paper, its claims, its ancestors, and for lessons."""

import os
import tomllib
from pathlib import Path

from rubnoise.errors import Refused, advised, did_you_mean

_PACKAGE = Path(__file__).parents[1]
_HOMES = (_PACKAGE / "shipped_scenarios", _PACKAGE.parents[1] / "scenarios")
"""Where an installed package keeps them, and where a checkout does."""


def _files() -> dict[str, Path]:
    """Return the path of every shipped scenario by its name, such as ``paper/fig5``, in alphabetical order."""
    home = next((home for home in _HOMES if home.is_dir()), _PACKAGE)
    return {path.relative_to(home).with_suffix("").as_posix(): path for path in sorted(home.glob("*/*.toml"))}


def shipped_names() -> tuple[str, ...]:
    """Return the names of all shipped scenarios, such as ``paper/fig5``, in alphabetical order."""
    return tuple(_files())


def shipped(name: str) -> Path:
    """Return the path of a scenario by its name, with or without ``.toml``; raises Refused, with near names."""
    files, wanted = _files(), _bare(name)
    if wanted in files:
        return files[wanted]
    raise Refused(advised(f"{name}: no scenario of rubnoise's", _advice(wanted)))


def _bare(name: str) -> str:
    return name.removesuffix(".toml").removeprefix("scenarios/")


def _advice(name: str) -> str:
    names = shipped_names()
    return did_you_mean(name, names, [each for each in names if each.rpartition("/")[2] == name], most=3)


def named(source: str | os.PathLike[str]) -> Path:
    """Return the path for a path or a name: an existing file, otherwise a shipped scenario, otherwise the path itself.

    Raises Refused, with near names, for a word without ``.toml`` that is neither.
    """
    path, text = Path(source), os.fspath(source)
    try:
        there = os.path.lexists(path)
    except ValueError:
        return path  # reading it says what is wrong
    if there or not isinstance(source, str | Path) or path.is_absolute():
        return path
    if _bare(text) in shipped_names():
        return shipped(text)
    if path.suffix or not (advice := _advice(text)):
        return path
    raise Refused(f"{text}: neither a file nor a scenario of rubnoise's; {advice}")


def shipped_titles() -> dict[str, str]:
    """Return the title of every shipped scenario by its name; one without a title has that of the file it extends."""
    return {name: _title(path) for name, path in _files().items()}


def _title(path: Path) -> str:
    data = tomllib.loads(path.read_text(encoding="utf-8"))
    if "title" in data:
        return str(data["title"])
    return _title(path.parent / data["extends"]) if "extends" in data else ""
