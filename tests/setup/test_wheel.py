"""The package that others install: the wheel, the source distribution that it is built from, the page on an index."""

import os
import shutil
import subprocess
import sys
import tarfile
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def dist(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("dist")
    command = [sys.executable, str(ROOT / "tools" / "build_package.py"), str(folder)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return folder


@pytest.fixture(scope="module")
def wheel(dist: Path) -> zipfile.ZipFile:
    return zipfile.ZipFile(next(dist.glob("*.whl")))


def tracked() -> set[str]:
    """Return the files of the repository."""
    if not (ROOT / ".git").exists() or shutil.which("git") is None:
        pytest.skip("no checkout, or no git: only git knows which files belong to it")
    command = ["git", "-C", str(ROOT), "ls-files", "--cached", "--others", "--exclude-standard"]
    found = subprocess.run(command, capture_output=True, text=True, check=True).stdout.splitlines()
    return {name for name in found if (ROOT / name).exists()}


def test_it_holds_every_module_and_nothing_of_the_workshop(wheel: zipfile.ZipFile) -> None:
    modules = {path.relative_to(ROOT / "src").as_posix() for path in (ROOT / "src" / "rubnoise").rglob("*.py")}
    held = {name for name in wheel.namelist() if ".dist-info/" not in name}
    assert held >= modules | {"rubnoise/py.typed"}
    assert all(name.startswith("rubnoise/") and "__pycache__" not in name for name in held)


def test_it_brings_the_command_and_the_licence(wheel: zipfile.ZipFile) -> None:
    [points] = [name for name in wheel.namelist() if name.endswith("entry_points.txt")]
    assert "rubnoise = rubnoise.__main__:main" in wheel.read(points).decode()
    assert any(name.endswith("licenses/LICENSE") for name in wheel.namelist())


def test_the_source_distribution_has_every_file(dist: Path) -> None:
    with tarfile.open(next(dist.glob("*.tar.gz"))) as archive:
        held = {name.partition("/")[2] for name in archive.getnames()}
    assert held - {"PKG-INFO"} == tracked()


def test_the_page_has_no_link_into_the_checkout(wheel: zipfile.ZipFile) -> None:
    [metadata] = [name for name in wheel.namelist() if name.endswith("METADATA")]
    page = wheel.read(metadata).decode().partition("\n\n")[2]
    assert page.startswith("# rubnoise")
    assert "](docs/" not in page


@pytest.mark.parametrize("tool", ["twine check --strict", "check_wheel_contents"])
def test_tools_of_the_index_accept_it(dist: Path, tool: str) -> None:
    module, *words = tool.split()
    pytest.importorskip(module)
    files = [str(path) for path in dist.iterdir() if module == "twine" or path.suffix == ".whl"]
    command = [sys.executable, "-m", module, *words, *files]
    done = subprocess.run(command, capture_output=True, text=True, check=False, env={**os.environ, "NO_COLOR": "1"})
    assert done.returncode == 0, done.stdout + done.stderr


def test_it_runs_where_nothing_but_the_wheel_is(dist: Path, tmp_path: Path) -> None:
    """Unpacked beside the dependencies, far from the checkout."""
    with zipfile.ZipFile(next(dist.glob("*.whl"))) as wheel:
        wheel.extractall(tmp_path / "installed")  # noqa: S202  (it was built here)
    code = "import sys; sys.path.insert(0, sys.argv.pop(1)); from rubnoise.__main__ import main; main()"
    shipped = tmp_path / "installed" / "rubnoise" / "shipped_scenarios" / "paper" / "fig5.toml"
    command = [sys.executable, "-c", code, str(tmp_path / "installed"), "check", str(shipped)]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert "mean diameter" in done.stdout
