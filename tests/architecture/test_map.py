"""The map on docs/design.md is drawn from the imports; tests/reading/test_pages.py refuses an outdated one."""

import shutil
from pathlib import Path

import grimp

from tests.architecture.sources import PACKAGE
from tools import package_map


def test_arrows_are_those_that_the_contract_is_checked_by() -> None:
    graph = grimp.build_graph("rubnoise", cache_dir=None)
    rooms = {f"rubnoise.{room}": room for layer in package_map.layers() for room in layer}
    for file, room in package_map.exceptions():
        importer = f"rubnoise.{file.replace('/', '.')}"
        for imported in graph.find_modules_directly_imported_by(importer) if importer in graph.modules else ():
            if imported.startswith(f"rubnoise.{room}."):
                graph.remove_import(importer=importer, imported=imported)
    for module in rooms:
        graph.squash_module(module)
    seen = {
        room: {rooms[each] for each in graph.find_modules_directly_imported_by(module) if each in rooms} - {room}
        for module, room in rooms.items()
    }
    assert package_map.arrows() == seen


def test_one_file_of_python_draws_and_no_other_arrow_is_left_out() -> None:
    assert package_map.exceptions() - {("rubnoise", "api")} == {("api/pictures", "figures")}
    assert "figures" not in package_map.arrows()["api"]


def test_every_arrow_goes_down() -> None:
    depth = {room: number for number, layer in enumerate(package_map.layers()) for room in layer}
    drawn = package_map.arrows()
    assert sum(map(len, drawn.values())) > 50
    assert all(depth[room] < depth[end] for room, ends in drawn.items() for end in ends if depth[room] != depth[end])


def test_a_new_import_draws_an_arrow(tmp_path: Path) -> None:
    shutil.copytree(PACKAGE, tmp_path / "rubnoise", ignore=shutil.ignore_patterns("__pycache__"))
    before = package_map.arrows(tmp_path / "rubnoise")
    (tmp_path / "rubnoise" / "contact" / "upwards.py").write_text("def late():\n    from rubnoise.sweep import pool\n")
    after = package_map.arrows(tmp_path / "rubnoise")
    assert before == package_map.arrows()
    assert after["contact"] - before["contact"] == {"sweep"}


def test_only_what_no_longer_way_says_is_drawn() -> None:
    drawn = {"a": {"b", "c", "d"}, "b": {"c"}, "c": {"d"}, "d": set()}
    assert package_map.shown_arrows(drawn) == {"a": {"b"}, "b": {"c"}, "c": {"d"}, "d": set()}
