"""What the command line asks of the tests, and values that take long to work out, kept in tests/reference/frozen."""

import json
from collections.abc import Callable
from datetime import UTC, datetime
from functools import cache, wraps
from pathlib import Path
from typing import Any
from zlib import crc32

import numpy as np
import pytest


# What the command line asks of the tests; set by conftest before any of them is loaded.
class Wishes:
    """Whether frozen values are to be written, and whether all is to be tried that there is time for."""

    freeze = False
    everything = False


def examples(few: int, many: int) -> int:
    """Return how many examples to try: few every day, many with --all."""
    return many if Wishes.everything else few


# Values that take long to work out, such as quadratures at many digits: kept in tests/reference/frozen.
KEPT = Path(__file__).parent / "reference" / "frozen"
ROUNDING = 1e-13
TURNS = 10
"""With --all a part of the values is worked out each day, all of them in so many days."""
WORKED_OUT: dict[Path, dict[str, Any]] = {}
"""What has been worked out so far, where --freeze asks for it."""


def frozen(function: Callable[..., Any]) -> Callable[..., Any]:
    """Keep what a function of numbers, texts and laws returns, which is made of numbers, lists and tuples."""
    path = KEPT / f"{Path(function.__code__.co_filename).stem}.{function.__name__}.json"

    @wraps(function)
    @cache
    def kept(*arguments: Any) -> Any:
        key = ", ".join(map(_named, arguments))
        if Wishes.freeze:
            return WORKED_OUT.setdefault(path, {}).setdefault(key, _plain(function(*arguments)))
        if Wishes.everything:
            assert key in _read(path), f"{path.name} has nothing for {key}; --freeze writes it"
            if (crc32(key.encode()) + datetime.now(UTC).toordinal()) % TURNS == 0:
                assert _flat(function(*arguments)) == pytest.approx(_flat(_read(path)[key]), rel=ROUNDING, abs=0.0)
        return _read(path)[key] if key in _read(path) else _plain(function(*arguments))

    return kept


def write() -> None:
    """Write what has been worked out, one file for each function and one line for each value."""
    KEPT.mkdir(parents=True, exist_ok=True)
    for path, values in WORKED_OUT.items():
        lines = [f"{json.dumps(key)}: {json.dumps(value)}" for key, value in sorted(values.items())]
        path.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")


class Said:
    """What calls say, kept in a file as `$ call` and the lines of its answer; --freeze writes them."""

    def __init__(self, path: Path) -> None:
        self._path = path
        parts = ("\n" + path.read_text(encoding="utf-8")).split("\n$ ")[1:]
        self.kept = {call: said.strip("\n") for call, _, said in (part.partition("\n") for part in parts)}

    def assert_said(self, call: str, said: str) -> None:
        """Compare what a call says now, or keep it."""
        if Wishes.freeze:
            self.kept[call] = said
            text = "\n".join(f"$ {each}\n{lines}\n" for each, lines in self.kept.items())
            self._path.write_text(text, encoding="utf-8")
        assert said == self.kept.get(call), "if it is right, pytest -n 0 --freeze with this file keeps it"


@cache
def _read(path: Path) -> dict[str, Any]:
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}


def _named(argument: Any) -> str:
    return repr(float(argument)) if isinstance(argument, float | np.floating) else str(argument)


def _plain(value: Any) -> Any:
    if isinstance(value, list | tuple | np.ndarray):
        return [_plain(each) for each in value]
    return int(value) if isinstance(value, int) else float(value)


def _flat(value: Any) -> list[float]:
    plain = _plain(value)
    return [number for each in plain for number in _flat(each)] if isinstance(plain, list) else [plain]
