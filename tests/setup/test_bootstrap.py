"""Parts of tools/bootstrap.py that a whole set-up does not reach."""

import ast
import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import pytest

TOOLS = Path(__file__).resolve().parents[2] / "tools"


@pytest.fixture(scope="module")
def bootstrap() -> ModuleType:
    spec = importlib.util.spec_from_file_location("bootstrap", TOOLS / "bootstrap.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_an_old_python_is_named_and_told_what_is_needed(bootstrap: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "version_info", (3, 9, 2, "final", 0))
    with pytest.raises(bootstrap.SetupFailed, match=r"Python 3\.11 or newer is needed, and .* is Python 3\.9\.2"):
        bootstrap.refuse_what_cannot_work()


@pytest.mark.parametrize("name", ["dev.py", "bootstrap.py"])
def test_an_old_python_can_read_the_file_that_refuses_it(name: str) -> None:
    assert ast.parse((TOOLS / name).read_text(encoding="utf-8"), feature_version=(3, 7))


@pytest.mark.parametrize("name", ["dev.py", "bootstrap.py"])
def test_only_the_standard_library_is_imported(name: str) -> None:
    tree = ast.parse((TOOLS / name).read_text(encoding="utf-8"))
    plain = {
        alias.name.split(".")[0] for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names
    }
    named = {str(node.module).split(".")[0] for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    assert plain | named <= sys.stdlib_module_names | {"bootstrap"}


def test_a_system_without_posix_is_refused(bootstrap: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bootstrap.os, "name", "nt")
    with pytest.raises(bootstrap.SetupFailed, match="WSL"):
        bootstrap.refuse_what_cannot_work()


@pytest.mark.parametrize(
    "listing",
    [
        "global.cert='a'\n:env:.cert='b'",
        ":env:.cert='b'\nglobal.cert='a'",
        "install.cert='b'\nglobal.cert='a'\nglobal.no-binary=':all:'\ndownload.cert='c'",
    ],
)
def test_the_stronger_setting_wins_in_any_order(bootstrap: ModuleType, listing: str) -> None:
    assert bootstrap.parse_settings(listing) == {"cert": "b"}


@pytest.mark.parametrize("text", ["", "{", "[]", '{"python": 1'])
def test_a_spoiled_stamp_counts_as_unfinished(bootstrap: ModuleType, tmp_path: Path, text: str) -> None:
    target = bootstrap.VirtualEnvironment(tmp_path)
    target.stamp.write_text(text, encoding="utf-8")
    assert bootstrap.read_stamp(target) == {}
