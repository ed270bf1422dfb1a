"""The files by which others find and cite the project agree with pyproject.toml and with each other."""

import json
import re
import tomllib
from functools import cache
from typing import Any

import pytest

from rubnoise.cli.app import COMMANDS
from tests.architecture.sources import ROOT
from tests.cli.terminal import call
from tools.package_page import repository, with_links

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
    assert cited["title"] in (answer := call("cite").out)
    assert f"version {cited['version']}" in answer
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


def test_the_recipe_builds_and_tests_what_pip_would() -> None:
    """By the schema of rattler-build, version 1; no builder is needed to see it."""
    yaml = pytest.importorskip("yaml")
    recipe = yaml.safe_load((ROOT / "packaging" / "conda" / "recipe.yaml").read_text(encoding="utf-8"))
    assert set(recipe) == {"schema_version", "package", "source", "build", "requirements", "tests", "about"}
    assert (recipe["schema_version"], recipe["package"]["name"]) == (1, project()["name"])
    assert (ROOT / "packaging" / "conda" / recipe["source"]["path"] / "pyproject.toml").is_file()
    build = recipe["build"]
    assert (build["noarch"], build["number"]) == ("python", 0)
    assert "--no-deps" in build["script"]
    assert "--no-build-isolation" in build["script"]
    commands = dict(each.split(" = ") for each in build["python"]["entry_points"])
    assert commands == project()["scripts"]
    system = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["build-system"]
    host = {each.replace(" ", "") for each in recipe["requirements"]["host"]}
    assert host == {f"python{project()['requires-python']}", "pip", *system["requires"]}
    words = [line.split() for each in recipe["tests"] for line in each.get("script", ())]
    assert {word[0] for word in words} == set(project()["scripts"])
    assert {word[1] for word in words} <= {"--version", *COMMANDS}
    assert recipe["about"]["license"] == project()["license"]
    assert recipe["about"]["summary"] == project()["description"]
    assert (ROOT / recipe["about"]["license_file"]).is_file()


def test_references_are_the_bibliography() -> None:
    """Each entry of the bibliography stands on the page with its DOI, and nothing else does."""
    listed = entries((ROOT / "docs" / "references.bib").read_text(encoding="utf-8"))
    page = (ROOT / "docs" / "theory.md").read_text(encoding="utf-8")
    rows = re.findall(
        r"^\| `(\w+)` \|.*\| (?:\[([^\]]+)\]\(https://doi\.org/([^)]+)\)|no DOI found) \|", page, re.MULTILINE
    )
    assert {key: shown or None for key, shown, _ in rows} == listed
    assert all(shown == target for _, shown, target in rows)
    assert len(listed) > 15


def test_what_the_paper_cites_is_in_its_bibliography() -> None:
    own = entries((ROOT / "paper" / "paper.bib").read_text(encoding="utf-8"))
    all_of_them = entries((ROOT / "docs" / "references.bib").read_text(encoding="utf-8"))
    assert own.items() <= all_of_them.items()
    cited = set(re.findall(r"(?<![\w.])@(\w+)", (ROOT / "paper" / "paper.md").read_text(encoding="utf-8")))
    assert cited == set(own)
