"""What `import rubnoise` and `rubnoise --help` give, and what they cost."""

import importlib.metadata
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import rubnoise
from rubnoise import api
from tests.architecture.sources import ROOT

HEAVY = "{'numpy', 'scipy', 'numba', 'h5py', 'pydantic', 'pint', 'simpy', 'matplotlib', 'mpmath', 'xarray'}"
IMPORT = "import rubnoise"
HELP = """
import contextlib, io
from rubnoise.cli.app import main
with contextlib.redirect_stdout(io.StringIO()) as shown, contextlib.suppress(SystemExit):
    sys.argv = ["rubnoise", "--help"]
    main()
assert "run" in shown.getvalue()
"""


def _loaded(code: str) -> set[str]:
    """Return the heavy libraries that a fresh Python has loaded after some code."""
    program = f"import sys\n{code}\nprint('loaded:', *sorted({HEAVY} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return set(done.stdout.split("loaded:")[1].split())


@pytest.mark.parametrize("code", [IMPORT, HELP], ids=["import rubnoise", "rubnoise --help"])
def test_nothing_heavy_is_loaded(code: str) -> None:
    assert _loaded(code) == set()


def test_who_opens_a_result_does_not_wait_for_what_runs_one() -> None:
    assert _loaded("import rubnoise\nrubnoise.open") == {"numpy"}


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
    homes = [name for names in api.HOMES.values() for name in names]
    assert sorted(homes) == sorted(api.__all__) == sorted(set(rubnoise.__all__) - {"__version__"})


def test_something_heavy_would_be_noticed() -> None:
    assert _loaded("import rubnoise, mpmath") == {"mpmath"}


@pytest.mark.parametrize("name", rubnoise.__all__)
def test_every_public_name_is_there_and_documented(name: str) -> None:
    assert getattr(rubnoise, name).__doc__


def test_public_names_are_listed() -> None:
    assert {"build", "load", "simulate", "run", "open", "exact", "__version__"} <= set(dir(rubnoise))


def test_an_unknown_name_is_refused_as_by_any_module() -> None:
    for module in (rubnoise, api):
        with pytest.raises(AttributeError, match=f"module '{module.__name__}' has no attribute 'nonsense'"):
            module.nonsense  # noqa: B018


def test_the_version_is_the_same_everywhere() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    citation = re.search(r"^version: (\S+)$", (ROOT / "CITATION.cff").read_text(encoding="utf-8"), re.MULTILINE)
    assert citation is not None
    assert {project["version"], citation[1], importlib.metadata.version("rubnoise")} == {rubnoise.__version__}


def test_python_m_rubnoise_is_the_command_line() -> None:
    done = subprocess.run([sys.executable, "-m", "rubnoise", "--help"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "run" in done.stdout
