"""Rules about the source files that no linter knows."""

import re
import sys
import tomllib
from collections.abc import Callable
from typing import TypeVar

import pytest

from tests.architecture.sources import PACKAGE, ROOT, files, imported_packages, undocumented

T = TypeVar("T")
MOST_LINES = 400
# With every type checker; with pydantic, which pins its own core exactly; with matplotlib, which cannot do without.
COMES_ALONG = {"_typeshed", "pydantic_core", "PIL"}


def _users(library: str) -> set[str]:
    """Return the package's folders (or files, at the top) that import a library."""
    return {path.relative_to(PACKAGE).parts[0] for path in files() if library in imported_packages(path.read_text())}


@pytest.mark.parametrize(("library", "owner"), [("h5py", "storage"), ("simpy", "simulation")])
def test_a_library_has_one_owner(library: str, owner: str) -> None:
    assert _users(library) == {owner}


def test_only_who_opens_a_file_knows_more_of_it_than_its_rows_and_what_it_says() -> None:
    name = re.compile(r"import .*\bRunFile\b")
    knowing = {path.relative_to(PACKAGE).as_posix() for path in files() if name.search(path.read_text())}
    elsewhere = {name for name in knowing if not name.startswith("storage/")}
    assert elsewhere == {"api/result.py", "cli/progress.py", "cli/loading.py"}


def test_imports_are_found_wherever_they_stand() -> None:
    text = "import a.b\nfrom c.d import e\nif True:\n    def f():\n        import g as h\nfrom . import i\n"
    assert imported_packages(text) == {"a", "c", "g", "rubnoise"}


def test_every_import_is_declared() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = [requirement for extra in project["optional-dependencies"].values() for requirement in extra]
    declared = {re.split(r"[<>=]", requirement)[0] for requirement in project["dependencies"] + extras}
    imported = set().union(*(imported_packages(path.read_text(encoding="utf-8")) for path in files()))
    assert imported - sys.stdlib_module_names - {"rubnoise"} - COMES_ALONG <= declared


def _of_every_file(measure: Callable[[str], T]) -> dict[str, T]:
    """Return what a function makes of the text of each of the package's files."""
    return {str(path.relative_to(PACKAGE)): measure(path.read_text(encoding="utf-8")) for path in files()}


def test_every_file_stays_readable() -> None:
    lines = _of_every_file(lambda text: len(text.splitlines()))
    assert len(lines) > 100
    assert {name: count for name, count in lines.items() if count > MOST_LINES} == {}


def test_public_names_of_every_file_are_documented() -> None:
    assert {name: found for name, found in _of_every_file(undocumented).items() if found} == {}


def test_a_missing_docstring_is_found() -> None:
    text = "def a(): 'x'\ndef b(): ...\nclass C:\n    'x'\n    def d(self): ...\n    def _e(self): ...\n"
    assert undocumented(text) == ["b", "C.d"]
