"""Faults put into a copy of the program are noticed; all of them are tried by `python3 tools/mutants.py`."""

import ast
import subprocess
import sys
from pathlib import Path

import mutants
import pytest
from mutations import MOMENTS, MUTANTS, TICKS, Edit, Mutant

from tests.architecture.sources import PACKAGE, ROOT

BY_NAME = {mutant.name: mutant for mutant in MUTANTS}
TITLE = '"""The physics of one run: frozen inputs in working units (um, s, kg) and what follows from them at once."""'


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return mutants.copy_into(tmp_path_factory.mktemp("copy"))


@pytest.mark.parametrize("name", BY_NAME)
def test_a_fault_still_applies_to_the_program(name: str) -> None:
    for path, text in mutants.applied(BY_NAME[name], PACKAGE).items():
        assert text != path.read_text(encoding="utf-8")
        ast.parse(text)


def test_faults_have_names_of_their_own_and_tests_that_exist() -> None:
    assert len(BY_NAME) == len(MUTANTS) > 20
    for mutant in MUTANTS:
        file, _, test = mutant.test.partition("::")
        assert f"def {test.partition('[')[0]}(" in (ROOT / file).read_text(encoding="utf-8")


@pytest.mark.parametrize("text", ["nothing of the kind", "self"])
def test_a_text_that_is_not_there_once_is_refused(text: str) -> None:
    with pytest.raises(mutants.DoesNotApply, match=r"src/rubnoise/model\.py has \d+ times, not once: "):
        mutants.applied(Mutant("nowhere", (Edit("model.py", text, ""),), TICKS), PACKAGE)


def test_edits_of_one_file_add_up() -> None:
    edits = (Edit("model.py", TITLE, "# one"), Edit("model.py", "# one", "# other"))
    assert next(iter(mutants.applied(Mutant("two", edits, TICKS), PACKAGE).values())).startswith("# other\n")


@pytest.mark.parametrize("name", ["spread 5 % too wide", "off-by-one tick"])
def test_a_fault_is_noticed(copy: Path, name: str) -> None:
    verdict = mutants.judged(BY_NAME[name], copy)
    assert verdict.killed
    assert verdict.evidence.startswith("identity" if BY_NAME[name].identity else "z = +3")


def test_no_fault_and_no_assertion_are_no_kill(copy: Path) -> None:
    harmless = Mutant("another comment", (Edit("model.py", TITLE, "# a comment"),), TICKS, identity=True)
    assert mutants.judged(harmless, copy).evidence == "survives"
    broken = Mutant("a crash", (Edit("model.py", TITLE, "raise RuntimeError"),), TICKS, identity=True)
    verdict = mutants.judged(broken, copy)
    assert not verdict.killed
    assert verdict.evidence.startswith("no assertion failed")
    assert (copy / "src" / "rubnoise" / "model.py").read_text() == (PACKAGE / "model.py").read_text()


def test_a_small_score_is_no_kill() -> None:
    faint = mutants.Trial(
        failures=("FAILED tests/x.py::y - assert not {}",), scores=((-7.9, "a"), (4.5, "b")), passed=False, report=""
    )
    assert mutants._evidence(Mutant("faint", (), MOMENTS), faint) == (False, "z = -7.9, a")


def test_a_name_that_is_none_is_refused() -> None:
    command = [sys.executable, str(ROOT / "tools" / "mutants.py"), "no such fault"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "no fault is called 'no such fault'; there are: 0.327 for 1/3, " in done.stderr
