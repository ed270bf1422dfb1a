"""What others get: locks, the site, the wheel, and the files by which they find and cite the project."""

import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tomllib
import zipfile
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from tests.architecture.sources import ROOT
from tests.shell.terminal import call
from tools.package_page import repository, with_links

pytestmark = pytest.mark.slow

# The constraints are complete, and say nothing about the machine they were made on.
PIN = re.compile(r"([a-z0-9-]+)==([\w.!+-]+)( ; .+)?")


def pins() -> list[tuple[str, str]]:
    """Return name and marker of every line of the constraints."""
    lines = (ROOT / "tools" / "constraints.txt").read_text(encoding="utf-8").splitlines()
    found = [PIN.fullmatch(line) for line in lines if not line.startswith("#")]
    assert None not in found
    return [(pin[1], pin[3] or "") for pin in found if pin]


def test_everything_the_project_asks_for_has_a_version() -> None:
    about = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    wanted = [*about["project"]["dependencies"], *about["build-system"]["requires"]]
    wanted += [each for group in about["dependency-groups"].values() for each in group]
    names = {re.split(r"[<>=!~;\[ ]", requirement)[0].lower() for requirement in wanted}
    assert names <= {name for name, _ in pins()}


def test_packages_that_dropped_an_old_python_are_pinned_twice() -> None:
    assert len(pins()) == len(set(pins()))
    markers = [marker for name, marker in pins() if name == "numpy"]
    assert markers == [" ; python_full_version < '3.12'", " ; python_full_version >= '3.12'"]


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


def test_lesson_viewer_sound_and_help_live_in_it(site: Path) -> None:
    for name, page in (("lesson", "lesson"), ("view", "viewer")):
        text = (site / "site" / f"{name}.html").read_text(encoding="utf-8")
        assert "</html>" in text
        assert len(text) < 5_000_000
        assert f'src="site/{name}.html"' in (site / f"{page}.html").read_text(encoding="utf-8")
    assert (site / "site" / "fig5.wav").read_bytes().startswith(b"RIFF")
    shown = (site / "commands.html").read_text(encoding="utf-8")
    assert all(f"rubnoise {name}" in shown for name in ("check", "run", "junctions", "compare", "verify", "theory"))
    assert "landmarks" in (site / "searchindex.js").read_text(encoding="utf-8")


@pytest.mark.parametrize("javascript", [True, False])
def test_no_page_of_the_first_scrolls_sideways_on_a_phone(site: Path, browser: Any, javascript: bool) -> None:  # noqa: FBT001
    """Without the script, tables do scroll: that of symbols is wider than a phone."""
    phone = browser.new_context(viewport={"width": 390, "height": 844}, java_script_enabled=javascript)
    page, wide = phone.new_page(), {}
    for name in ("start", "model", "scenarios", "reading", "your-data"):
        page.goto((site / "docs" / f"{name}.html").as_uri())
        tables = page.locator(".table-wrapper").all()
        wide[name] = sum(each.evaluate("it => it.scrollWidth > it.clientWidth + 1") for each in tables)
    phone.close()
    assert bool(wide["model"]) is not javascript
    assert not javascript or sum(wide.values()) == 0


# The package that others install: the wheel, the source distribution that it is built from, the page on an index.
@pytest.fixture(scope="module")
def dist(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a source distribution, and with the wheel that is built from it."""
    folder = tmp_path_factory.mktemp("dist")
    build = [sys.executable, "-m", "hatchling", "build", f"--directory={folder}", "--target"]
    subprocess.run([*build, "sdist"], cwd=ROOT, capture_output=True, check=True)
    source = next(folder.glob("*.tar.gz"))
    with tarfile.open(source) as archive:
        archive.extractall(unpacked := tmp_path_factory.mktemp("unpacked"), filter="data")
    subprocess.run(
        [*build, "wheel"], cwd=unpacked / source.name.removesuffix(".tar.gz"), capture_output=True, check=True
    )
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
    assert "tools/" not in page
    commands = re.findall(r"^ {4}rubnoise (\w+)", page, re.MULTILINE)
    assert commands == ["run", "page", "plot"]
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
    assert "calibrated diameter" in done.stdout


# The files by which others find and cite the project agree with pyproject.toml and with each other.
BIB = re.compile(r"^@\w+\{(\w+),\n(.*?)^\}", re.MULTILINE | re.DOTALL)


@cache
def project() -> dict[str, Any]:
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def entries(text: str) -> dict[str, str | None]:
    """Return the DOI of every entry of a bibliography, by its key."""
    dois = {key: re.search(r"doi = \{([^}]+)\}", body) for key, body in BIB.findall(text)}
    return {key: found[1] if found else None for key, found in dois.items()}


def citation() -> dict[str, str]:
    """Return the plain fields at the top of CITATION.cff."""
    text = (ROOT / "CITATION.cff").read_text(encoding="utf-8").partition("\nreferences:")[0]
    return {name: value.strip('"') for name, value in re.findall(r"^([\w-]+): (.+)$", text, re.MULTILINE)}


def test_name_version_and_licence_agree() -> None:
    code = json.loads((ROOT / "codemeta.json").read_text(encoding="utf-8"))
    zenodo = json.loads((ROOT / ".zenodo.json").read_text(encoding="utf-8"))
    cited = citation()
    version, licence = project()["version"], project()["license"]
    assert {code["version"], zenodo["version"], cited["version"]} == {version}
    assert code["license"] == f"https://spdx.org/licenses/{licence}"
    assert {zenodo["license"], cited["license"]} == {licence}
    assert code["name"] == project()["name"]
    assert cited["title"] == zenodo["title"]
    assert call("--version").out.startswith(f"rubnoise {cited['version']}")
    assert code["description"] == project()["description"]


def test_authors_and_keywords_agree() -> None:
    code = json.loads((ROOT / "codemeta.json").read_text(encoding="utf-8"))
    zenodo = json.loads((ROOT / ".zenodo.json").read_text(encoding="utf-8"))
    names = [author["name"] for author in project()["authors"]]
    assert [author["name"] for author in code["author"]] == names
    assert [author["name"] for author in zenodo["creators"]] == names
    text = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert all(f'name: "{name}"' in text for name in names)
    assert code["keywords"] == zenodo["keywords"] == project()["keywords"]
    assert set(re.findall(r"^  - ([\w -]+)$", text, re.MULTILINE)) <= set(project()["keywords"])


def test_python_versions_agree() -> None:
    code = json.loads((ROOT / "codemeta.json").read_text(encoding="utf-8"))
    assert code["runtimePlatform"] == [f"Python {project()['requires-python'].removeprefix('>=')} or newer"]
    versions = [each.rpartition(" ")[2] for each in project()["classifiers"] if re.search(r":: 3\.\d+$", each)]
    workflow = (ROOT / ".github" / "workflows" / "tests.yml").read_text(encoding="utf-8")
    assert all(f'"{version}"' in workflow for version in versions)
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert f"Python {', '.join(versions[:-1])} or {versions[-1]}" in readme


def test_the_address_is_the_same_everywhere_or_nowhere() -> None:
    """[tool.rubnoise] in pyproject.toml is the one place where it is set."""
    address = repository(ROOT)
    code = json.loads((ROOT / "codemeta.json").read_text(encoding="utf-8"))
    assert (code.get("codeRepository", ""), citation().get("repository-code", "")) == (address, address)


def test_links_of_the_readme_work_on_an_index() -> None:
    page = "[a](docs/a.md) ![p](docs/p.png) [w](https://w.org) [h](#here)"
    assert with_links(page, "", "v1") == "a  [w](https://w.org) [h](#here)"
    full = with_links(page, "https://x.org/r", "v1")
    assert "[a](https://x.org/r/blob/v1/docs/a.md) ![p](https://x.org/r/raw/v1/docs/p.png)" in full
    readme = with_links((ROOT / "README.md").read_text(encoding="utf-8"), "https://x.org/r", "v1")
    assert re.findall(r"\]\((?!https://|#)[^)]*\)", readme) == []


def test_the_recipe_asks_for_what_the_package_needs() -> None:
    recipe = (ROOT / "packaging" / "conda" / "recipe.yaml").read_text(encoding="utf-8")
    run = recipe.partition("  run:\n")[2].partition("\n\n")[0]
    wanted = [
        f"python {project()['requires-python']}",
        *(each.replace(">=", " >=") for each in project()["dependencies"]),
    ]
    assert [line.removeprefix("    - ") for line in run.splitlines()] == wanted
    assert f'version: "{project()["version"]}"' in recipe


def test_the_page_names_the_references_without_a_doi() -> None:
    listed = entries((ROOT / "docs" / "references.bib").read_text(encoding="utf-8"))
    page = (ROOT / "docs" / "theory.md").read_text(encoding="utf-8").partition("Without a DOI: ")[2].partition(".\n")[0]
    assert len(listed) > 15
    assert page.count(",") + 1 == sum(doi is None for doi in listed.values())
