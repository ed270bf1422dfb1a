"""What others get: locks, the site, the wheel."""

import os
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from pathlib import Path

import pytest

from tests.cli.terminal import call

# The locks are complete, hashed, and say nothing about the machine they were made on.
ROOT = Path(__file__).resolve().parents[2]
PIN = re.compile(r"([a-z0-9-]+)==([\w.!+-]+)( ; [^\\]+)? \\")
HASH = re.compile(r"    --hash=sha256:[0-9a-f]{64}( \\)?")


def _lines(lock: str) -> list[str]:
    text = (ROOT / "tools" / f"{lock}.lock").read_text(encoding="utf-8")
    return [line for line in text.splitlines() if line and not line.lstrip().startswith("#")]


def _pins(lock: str) -> list[tuple[str, str, str]]:
    found = [PIN.fullmatch(line) for line in _lines(lock)]
    return [(pin[1], pin[2], pin[3] or "") for pin in found if pin]


def _names(requirements: list[str]) -> set[str]:
    return {re.split(r"[<>=!~;\[ ]", requirement)[0].lower() for requirement in requirements}


@pytest.mark.parametrize("lock", ["run", "sync", "test", "all", "bench", "docs"])
def test_a_lock_is_pins_and_hashes_and_nothing_else(lock: str) -> None:
    strange = [line for line in _lines(lock) if not (PIN.fullmatch(line) or HASH.fullmatch(line))]
    assert strange == []


@pytest.mark.parametrize("lock", ["run", "sync", "test", "all", "bench", "docs"])
def test_no_lock_names_an_index_or_a_path(lock: str) -> None:
    text = (ROOT / "tools" / f"{lock}.lock").read_text(encoding="utf-8")
    assert not re.search(r"://|file:| /|--index|--find-links|@ ", text)


def test_everything_the_project_asks_for_is_locked() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    groups = project["dependency-groups"]
    run = {name for name, _, _ in _pins("run")}
    test = {name for name, _, _ in _pins("test")}
    assert _names(project["project"]["dependencies"] + groups["build"] + project["build-system"]["requires"]) <= run
    sync = {name for name, _, _ in _pins("sync")}
    assert _names(groups["sync"]) <= run | sync
    assert _names(groups["test"]) <= run | sync | test
    everything = {name for name, _, _ in _pins("all")}
    assert _names(groups["all"]) <= run | sync | test | everything
    assert not sync & test
    assert not (sync | test) & everything
    assert _names(groups["bench"]) <= run | {name for name, _, _ in _pins("bench")}


@pytest.mark.parametrize("lock", ["sync", "test", "all", "bench", "docs"])
def test_the_other_locks_only_add(lock: str) -> None:
    assert not {name for name, _, _ in _pins("run")} & {name for name, _, _ in _pins(lock)}


def test_what_the_benchmark_compares_with_is_in_no_other_lock() -> None:
    peers = {"ciw", "salabim", "superposed-pulses"}
    assert peers <= {name for name, _, _ in _pins("bench")}
    assert not peers & {name for lock in ("run", "sync", "test", "all") for name, _, _ in _pins(lock)}


def test_packages_that_dropped_an_old_python_are_pinned_twice() -> None:
    numpy = [pin for pin in _pins("run") if pin[0] == "numpy"]
    assert [marker for _, _, marker in numpy] == [" ; python_full_version < '3.12'", " ; python_full_version >= '3.12'"]


# The site: built without a warning in an environment of its own, where its packages can be installed.
PYTHON = ROOT / ".venv-docs" / "bin" / "python"


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site") / "site"
    command = [sys.executable, str(ROOT / "tools" / "dev.py"), "docs", str(folder)]
    if PYTHON.exists():  # it is set up, and its tests need not wait for the network
        command = [str(PYTHON), str(ROOT / "tools" / "build_site.py"), str(folder)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    if "installing failed" in done.stderr:
        pytest.skip("the packages for the site cannot be installed here")
    assert done.returncode == 0, done.stderr[-3000:]
    return folder


def test_every_link_of_the_site_leads_to_a_file_and_a_place(site: Path) -> None:
    pages = {path: path.read_text(encoding="utf-8") for path in site.rglob("*.html") if path.parent != site / "site"}
    assert len(pages) > 30
    broken = []
    for path, text in pages.items():
        for target in re.findall(r'(?:href|src)="(?!https?:|data:|mailto:)([^"]*)"', text):
            name, _, anchor = target.partition("#")
            found = (path.parent / name.partition("?")[0]).resolve() if name else path
            if not found.exists() or (anchor and found in pages and f'id="{anchor}"' not in pages[found]):
                broken.append(f"{path.relative_to(site)}: {target}")
    assert broken == []


def test_lesson_viewer_sound_and_outputs_live_in_it(site: Path) -> None:
    for name, page in (("lesson", "lesson"), ("view", "viewer")):
        text = (site / "site" / f"{name}.html").read_text(encoding="utf-8")
        assert "</html>" in text
        assert len(text) < 5_000_000
        assert f'src="site/{name}.html"' in (site / f"{page}.html").read_text(encoding="utf-8")
    assert (site / "site" / "fig5.wav").read_bytes().startswith(b"RIFF")
    shown = (site / "outputs.html").read_text(encoding="utf-8")
    assert all(f"rubnoise {name}" in shown for name in ("check", "run", "junction", "compare", "verify", "theory"))
    assert "landmarks" in (site / "searchindex.js").read_text(encoding="utf-8")


def test_the_gallery_is_in_it_with_its_pictures(site: Path) -> None:
    page = (site / "docs" / "gallery.html").read_text(encoding="utf-8")
    pictures = re.findall(r'<img[^>]* src="([^"]+\.png)"', page)
    assert len(pictures) > 30
    assert all((site / "docs" / name).resolve().is_file() for name in pictures)
    assert "rubnoise plot fig5.h5 lifelines" in page


def test_nothing_but_a_site_is_replaced(tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("mine", encoding="utf-8")
    command = [sys.executable, str(ROOT / "tools" / "build_site.py"), str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "is not a site" in done.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


# The package that others install: the wheel, the source distribution that it is built from, the page on an index.
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
    pages = {f"rubnoise/docs/{path.name}" for path in (ROOT / "docs").glob("*.md")}
    assert held >= modules | pages | {"rubnoise/py.typed", "rubnoise/docs/pictures/drawn/sketch.svg"}
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
    assert "tools/" not in page
    commands = re.findall(r"^ {4}rubnoise (\w+)", page, re.MULTILINE)
    assert commands == ["run", "view", "plot", "docs"]
    said = call("--help").out
    assert all(command in said for command in commands)


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
    done = subprocess.run([*command[:-2], "docs"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, (tmp_path / "rubnoise.html").stat().st_size < 2_000_000) == (0, True), done.stderr
