"""Values that are kept are those that are worked out, and a wrong one is found."""

import json
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests import frozen
from tests.frozen import Wishes


@pytest.fixture
def calls(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[list[float]]:
    monkeypatch.setattr(frozen, "KEPT", tmp_path)
    monkeypatch.setattr(frozen, "WORKED_OUT", {})
    frozen._read.cache_clear()
    yield []
    frozen._read.cache_clear()


def _slow(calls: list[float]) -> Callable[[float], list[list[float]]]:
    @frozen.frozen
    def slow(x: float) -> list[list[float]]:
        calls.append(x)
        return [[x, 2.0 * x], [3.0 * x]]

    return slow


def test_what_is_kept_is_not_worked_out_again(calls: list[float], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Wishes, "freeze", True)
    assert _slow(calls)(0.1) == [[0.1, 0.2], [3.0 * 0.1]]
    frozen.write()
    monkeypatch.setattr(Wishes, "freeze", False)
    monkeypatch.setattr(Wishes, "everything", False)
    assert _slow(calls)(0.1) == [[0.1, 0.2], [3.0 * 0.1]]
    assert calls == [0.1]
    assert _slow(calls)(0.2)[1] == [3.0 * 0.2]
    assert calls == [0.1, 0.2]


def test_all_works_it_out_and_finds_what_is_wrong_or_missing(
    calls: list[float], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept = {"0.1": [[0.1, 0.2], [3.0 * 0.1]], "0.2": [[0.2, 0.4], [0.6 * (1.0 + 1e-12)]]}
    (tmp_path / "test_frozen.slow.json").write_text(json.dumps(kept), encoding="utf-8")
    monkeypatch.setattr(Wishes, "freeze", False)
    monkeypatch.setattr(Wishes, "everything", True)
    assert _slow(calls)(0.1) == kept["0.1"]
    with pytest.raises(AssertionError):
        _slow(calls)(0.2)
    with pytest.raises(AssertionError, match=r"has nothing for 0\.3"):
        _slow(calls)(0.3)
    assert calls == [0.1, 0.2]
