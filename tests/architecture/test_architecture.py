"""Imports go down only, as the map shows; rules about source files; what an import costs."""

import importlib.metadata
import os
import re
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

import pytest

import rubnoise
from tests.architecture.sources import PACKAGE, ROOT, files, imported_packages, undocumented

# Imports go down only, as the contract in pyproject.toml says.
LINT = "import sys; from importlinter.cli import lint_imports; sys.exit(lint_imports(no_cache=True))"


def _lint(folder: Path) -> tuple[int, str]:
    environment = {**os.environ, "PYTHONPATH": str(folder / "src"), "COLUMNS": "200"}
    done = subprocess.run(
        [sys.executable, "-c", LINT], cwd=folder, env=environment, capture_output=True, text=True, check=False
    )
    return done.returncode, done.stdout + done.stderr


def test_the_contract_is_kept() -> None:
    code, report = _lint(ROOT)
    assert code == 0, report


@pytest.mark.slow
def test_breaches_are_seen(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "src", tmp_path / "src", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    package = tmp_path / "src" / "rubnoise"
    for module, statement in {
        "contact/upwards": "from rubnoise.simulation import run",
        "theory/sideways": "def late():\n    from rubnoise.simulation import run",
        "inference/downwards": "from rubnoise.simulation import run",
        "unlisted": "",
    }.items():
        (package / f"{module}.py").write_text(f"{statement}\n", encoding="utf-8")
    (package / "streams.py").write_text("from rubnoise import errors\n", encoding="utf-8")
    code, report = _lint(tmp_path)
    assert code == 1, report
    for breach in (
        "rubnoise.contact.upwards -> rubnoise.simulation.run (l.1)",
        "rubnoise.theory.sideways -> rubnoise.simulation.run (l.2)",
        "rubnoise.streams -> rubnoise.errors (l.1)",
        "rubnoise.inference.downwards -> rubnoise.simulation.run (l.1)",
        "The following modules are not listed as layers:\n\n- rubnoise.unlisted\n",
    ):
        assert breach in report


def test_no_import_goes_up() -> None:
    contract = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"][
        "contracts"
    ][0]
    assert contract["ignore_imports"] == ["rubnoise -> rubnoise.**"]


# What `import rubnoise` gives, and what it costs; tests/shell/test_help.py asks every command for its help.
HEAVY = "{'numpy', 'scipy', 'numba', 'h5py', 'pydantic', 'pint', 'simpy', 'matplotlib', 'mpmath', 'xarray'}"


def _loaded(code: str) -> set[str]:
    """Return the heavy libraries that a fresh Python has loaded after some code."""
    program = f"import sys\n{code}\nprint('loaded:', *sorted({HEAVY} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return set(done.stdout.split("loaded:")[1].split())


def test_nothing_heavy_is_loaded() -> None:
    assert _loaded("import rubnoise") == set()


def test_who_opens_a_result_does_not_wait_for_what_runs_one() -> None:
    assert _loaded("import rubnoise\nrubnoise.open") == {"numpy", "h5py"}


@pytest.mark.slow
def test_what_only_reads_loads_no_compiler(tmp_path: Path) -> None:
    rubnoise.run(rubnoise.example("paper/fig4").replace(distance="50 um"), tmp_path / "x.h5").close()
    info = f"""
import contextlib, io
from rubnoise.cli.app import main
with contextlib.redirect_stdout(io.StringIO()) as shown, contextlib.suppress(SystemExit):
    sys.argv = ["rubnoise", "info", {str(tmp_path / "x.h5")!r}]
    main()
assert "trace" in shown.getvalue()
"""
    assert _loaded(info) & {"numba", "scipy", "simpy", "pint", "matplotlib"} == set()
    assert _loaded(f"import rubnoise; rubnoise.open({str(tmp_path / 'x.h5')!r})") == {"numpy", "h5py"}
    assert "numba" in _loaded("import rubnoise; rubnoise.simulate")


def test_every_public_name_has_one_home() -> None:
    homes = [name for names in rubnoise.HOMES.values() for name in names]
    assert sorted([*homes, "__version__"]) == rubnoise.__all__


def test_something_heavy_would_be_noticed() -> None:
    assert _loaded("import rubnoise, mpmath") == {"mpmath"}


@pytest.mark.parametrize("name", rubnoise.__all__)
def test_every_public_name_is_there_and_documented(name: str) -> None:
    assert getattr(rubnoise, name).__doc__


def test_public_names_are_listed() -> None:
    assert {"build", "load", "simulate", "run", "open", "exact", "__version__"} <= set(dir(rubnoise))


def test_an_unknown_name_is_refused_as_by_any_module() -> None:
    with pytest.raises(AttributeError, match="module 'rubnoise' has no attribute 'nonsense'"):
        rubnoise.nonsense  # noqa: B018


def test_the_version_is_the_same_everywhere() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    citation = re.search(r"^version: (\S+)$", (ROOT / "CITATION.cff").read_text(encoding="utf-8"), re.MULTILINE)
    assert citation is not None
    assert {project["version"], citation[1], importlib.metadata.version("rubnoise")} == {rubnoise.__version__}


@pytest.mark.slow
def test_python_m_rubnoise_is_the_command_line() -> None:
    done = subprocess.run([sys.executable, "-m", "rubnoise", "--help"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "run" in done.stdout


# Rules about the source files that no linter knows.
T = TypeVar("T")
MOST_LINES = 400
# With every type checker; with pydantic, which pins its own core exactly; with matplotlib, which cannot do without.
COMES_ALONG = {"_typeshed", "pydantic_core", "PIL"}


def _users(library: str) -> set[str]:
    """Return the package's folders (or files, at the top) that import a library."""
    return {path.relative_to(PACKAGE).parts[0] for path in files() if library in imported_packages(path.read_text())}


@pytest.mark.slow
@pytest.mark.parametrize(("library", "owner"), [("h5py", "storage"), ("simpy", "simulation")])
def test_a_library_has_one_owner(library: str, owner: str) -> None:
    assert _users(library) == {owner}


def test_only_who_opens_a_file_knows_more_of_it_than_its_rows_and_what_it_says() -> None:
    name = re.compile(r"import .*\bRunFile\b")
    knowing = {path.relative_to(PACKAGE).as_posix() for path in files() if name.search(path.read_text())}
    elsewhere = {name for name in knowing if not name.startswith("storage/")}
    assert elsewhere == {"api/run.py", "api/running.py", "cli/loading.py", "runs/verification.py"}


def test_imports_are_found_wherever_they_stand() -> None:
    text = "import a.b\nfrom c.d import e\nif True:\n    def f():\n        import g as h\nfrom . import i\n"
    assert imported_packages(text) == {"a", "c", "g", "rubnoise"}


@pytest.mark.slow
def test_every_import_is_declared() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = [requirement for extra in project["optional-dependencies"].values() for requirement in extra]
    names = {re.split(r"[<>=]", requirement)[0] for requirement in project["dependencies"] + extras}
    imported = set().union(*(imported_packages(path.read_text(encoding="utf-8")) for path in files()))
    assert imported - sys.stdlib_module_names - {"rubnoise"} - COMES_ALONG <= names


def _of_every_file(measure: Callable[[str], T]) -> dict[str, T]:
    """Return what a function makes of the text of each of the package's files."""
    return {str(path.relative_to(PACKAGE)): measure(path.read_text(encoding="utf-8")) for path in files()}


def test_every_file_stays_readable() -> None:
    lines = _of_every_file(lambda text: len(text.splitlines()))
    assert len(lines) > 100
    assert {name: count for name, count in lines.items() if count > MOST_LINES} == {}


@pytest.mark.slow
def test_public_names_of_every_file_are_documented() -> None:
    assert {name: found for name, found in _of_every_file(undocumented).items() if found} == {}


def test_a_missing_docstring_is_found() -> None:
    text = "def a(): 'x'\ndef b(): ...\nclass C:\n    'x'\n    def d(self): ...\n    def _e(self): ...\n"
    assert undocumented(text) == ["b", "C.d"]
