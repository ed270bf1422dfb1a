"""The scenario files that come with rubnoise: of the paper, its claims, its ancestors, and for lessons."""

import os
import tomllib
from difflib import get_close_matches
from pathlib import Path

from rubnoise.errors import Refused

_PACKAGE = Path(__file__).parents[1]
_HOMES = (_PACKAGE / "shipped_scenarios", _PACKAGE.parents[1] / "scenarios")
"""Where an installed package keeps them, and where a checkout does."""


def shipped(name: str) -> Path:
    """Return the path of a scenario file that comes with rubnoise, such as ``paper/fig5.toml``.

    Raises Refused if the installation does not have it.
    """
    for home in _HOMES:
        path = home / name
        if path.is_file():
            return path
    raise Refused(f"scenarios/{name}: not found beside rubnoise in {_PACKAGE}; is the installation complete?")


def shipped_names() -> tuple[str, ...]:
    """Return the names of all shipped scenarios, such as ``paper/fig5``, in alphabetical order."""
    home = next((home for home in _HOMES if home.is_dir()), None)
    paths = [] if home is None else [path.relative_to(home) for path in home.glob("*/*.toml")]
    return tuple(sorted(path.with_suffix("").as_posix() for path in paths))


def by_name(name: str) -> Path:
    """Return the path of a scenario by its name, with or without ``.toml``; raises Refused, with near names."""
    wanted = name.removesuffix(".toml").removeprefix("scenarios/")
    if wanted in shipped_names():
        return shipped(f"{wanted}.toml")
    near = _near(wanted)
    raise Refused(f"{name}: no scenario of rubnoise's" + (f"; did you mean {' or '.join(near)}?" if near else ""))


def _near(name: str) -> list[str]:
    names = shipped_names()
    return [each for each in names if each.rpartition("/")[2] == name] or get_close_matches(name, names, n=3)


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
    if text.removesuffix(".toml").removeprefix("scenarios/") in shipped_names():
        return by_name(text)
    near = _near(text)
    if path.suffix or not near:
        return path
    raise Refused(f"{text}: neither a file nor a scenario of rubnoise's; did you mean {' or '.join(near)}?")


def shipped_titles() -> dict[str, str]:
    """Return the title of every shipped scenario by its name; one without a title has that of the file it extends."""
    return {name: _title(by_name(name)) for name in shipped_names()}


def _title(path: Path) -> str:
    data = tomllib.loads(path.read_text(encoding="utf-8"))
    if "title" in data:
        return str(data["title"])
    return _title(path.parent / data["extends"]) if "extends" in data else ""
