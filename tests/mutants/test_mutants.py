"""Faults put into a copy of the program are noticed, and kept values are those that are worked out."""

import json
from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from pathlib import Path

import mutants
import pytest
from mutants import MUTANTS, ROOMS, Edit, Mutant

from tests import frozen
from tests.architecture.sources import PACKAGE, ROOT
from tests.frozen import Wishes

# Faults put into a copy of the program are noticed; all of them are tried by `python3 tools/mutants.py`.
MOMENTS = "test_births_count_and_area_of_one_size"
STREAMS = "test_streams_and_their_numbers_never_change"
"""A test that compiles nothing."""
EVERY = 30
TODAY = MUTANTS[datetime.now(UTC).toordinal() % EVERY :: EVERY]
"""A part of the faults is tried each day, all of them in so many days; CI tries all every week."""

BY_NAME = {mutant.name: mutant for mutant in MUTANTS}
TITLE = (PACKAGE / "model.py").read_text(encoding="utf-8").partition("\n")[0]
TEXTS = mutants.sources(PACKAGE)


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return mutants.copy_into(tmp_path_factory.mktemp("copy"))


@pytest.mark.slow
def test_every_fault_still_applies_to_the_program() -> None:
    for mutant in MUTANTS:
        for path, text in mutants.applied(mutant, TEXTS).items():
            assert text != TEXTS[path], mutant.name
            if path.suffix == ".py":
                compile(text, path, "exec")


def test_every_fault_has_a_name_of_its_own_and_a_test_that_exists() -> None:
    assert len(BY_NAME) == len(MUTANTS) >= 100
    for mutant in MUTANTS:
        file, _, _test = mutants.test_of(mutant, ROOT).partition("::")
        assert (ROOT / file).is_file()


@pytest.mark.slow
def test_faults_lie_in_every_room() -> None:
    folders = {path.name for path in PACKAGE.iterdir() if (path / "__init__.py").exists()}
    touched = {path.relative_to(PACKAGE).parts[0] for m in MUTANTS for path in mutants.applied(m, TEXTS)}
    assert folders <= touched
    assert set(ROOMS) == folders
    assert all(len(faults) >= 2 for faults in ROOMS.values())


def test_a_text_is_found_wherever_and_however_indented_it_stands() -> None:
    moved = Path("another") / "place.py"
    texts = {moved: "class A:\n        value = (\n            1 +   2)\n        rest = 3\n"}
    path, text = mutants.mutated(texts, Edit("value = ( 1 + 2)", "value = 4\nother = 5"))
    assert path == moved
    assert text == "class A:\n        value = 4\n        other = 5\n        rest = 3\n"


@pytest.mark.parametrize("text", ["no such text in any file", "return"])
def test_a_text_that_is_not_there_once_is_refused(text: str) -> None:
    with pytest.raises(mutants.DoesNotApply, match=r"src/rubnoise has \d+ times, not once: "):
        mutants.applied(Mutant("nowhere", (Edit(text, ""),), STREAMS), TEXTS)


@pytest.mark.slow
def test_the_faults_whose_turn_it_is_are_noticed(copy: Path) -> None:
    """In one case, since each copy compiles its kernels."""
    verdicts = {mutant.name: mutants.judged(mutant, copy) for mutant in TODAY}
    assert {name: each.evidence for name, each in verdicts.items() if not each.killed} == {}


@pytest.mark.slow
def test_no_fault_and_no_assertion_are_no_kill(copy: Path) -> None:
    harmless = Mutant("another comment", (Edit(TITLE, "# a comment"),), STREAMS)
    assert mutants.judged(harmless, copy).evidence == "survives"
    broken = Mutant("a crash", (Edit(TITLE, "raise RuntimeError"),), STREAMS)
    verdict = mutants.judged(broken, copy)
    assert not verdict.killed
    assert verdict.evidence.startswith("no assertion failed")
    assert (copy / "src" / "rubnoise" / "model.py").read_text() == (PACKAGE / "model.py").read_text()


@pytest.mark.slow
def test_columns_that_differ_are_no_long_work_in_a_service(copy: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CI", "true")
    test = copy / "tests" / "test_columns.py"
    test.write_text(
        "import random\n\n\ndef test_columns():\n"
        "    assert {'x': random.Random(1).randbytes(1000000)} == {'x': random.Random(2).randbytes(1000000)}\n",
        encoding="utf-8",
    )
    trial = mutants.tried(copy, [str(test)], seconds=60.0)
    test.unlink()
    assert [failure.partition(" {")[0] for failure in trial.failures] == [
        "FAILED tests/test_columns.py::test_columns - assert"
    ]


def test_a_small_score_is_no_kill() -> None:
    faint = mutants.Trial(
        failures=("FAILED tests/x.py::y - assert not {}",), scores=((-7.9, "a"), (4.5, "b")), passed=False, report=""
    )
    assert mutants._evidence(Mutant("faint", (), MOMENTS, chance=True), faint) == (False, "z = -7.9, a")


# Values that are kept are those that are worked out, and a wrong one is found.
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
    (tmp_path / "test_mutants.slow.json").write_text(json.dumps(kept), encoding="utf-8")
    monkeypatch.setattr(Wishes, "freeze", False)
    monkeypatch.setattr(Wishes, "everything", True)
    monkeypatch.setattr(frozen, "TURNS", 1)
    assert _slow(calls)(0.1) == kept["0.1"]
    with pytest.raises(AssertionError):
        _slow(calls)(0.2)
    with pytest.raises(AssertionError, match=r"has nothing for 0\.3"):
        _slow(calls)(0.3)
    assert calls == [0.1, 0.2]
