"""The reference pages say what the code says."""

import re
from pathlib import Path

import h5py
import pytest

from rubnoise.scenario.reading import loads
from rubnoise.storage.schema import GROUPS
from rubnoise.storage.seal import INTERVENTION
from tools import generate_docs

DOCS = Path(__file__).parents[2] / "docs"


@pytest.mark.parametrize("page", generate_docs.PAGES)
def test_generated_parts_are_those_of_the_code(page: str) -> None:
    text = generate_docs.read(page)
    assert "<!-- generated: " in text
    assert generate_docs.generated(text) == text, "python tools/generate_docs.py"


def test_a_part_that_is_out_of_date_is_named_and_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for page in generate_docs.PAGES:
        kind = "float64" if page == "data-format.md" else "float63"
        (tmp_path / page).write_text((DOCS / page).read_text(encoding="utf-8").replace(kind, "float32"), "utf-8")
    monkeypatch.setattr(generate_docs, "DOCS", tmp_path)
    assert generate_docs.main(["--check"]) == 1
    assert generate_docs.main([]) == 0
    assert generate_docs.main(["--check"]) == 0
    assert capsys.readouterr().out.splitlines() == [
        "docs/data-format.md is out of date",
        "docs/data-format.md written",
    ]


def test_every_column_is_listed_under_its_group() -> None:
    text = generate_docs.read("data-format.md")
    for group in GROUPS:
        section = text.partition(f"### /{group.name}\n")[2].partition("\n##")[0]
        assert re.findall(r"^\| `(\w+)`", section, re.MULTILINE) == [column.name for column in group.columns]


def listed(title: str) -> set[str]:
    """Return the names in the first column of a section's table."""
    section = generate_docs.read("data-format.md").partition(f"\n## {title}\n")[2].partition("\n## ")[0]
    cells = re.findall(r"^\| (`[^|]+`) \|", section, re.MULTILINE)
    return {name for cell in cells for name in re.findall(r"`(\w+)`", cell)}


def test_the_attributes_of_root_and_provenance_are_listed(folder: Path) -> None:
    with h5py.File(folder / "fig5.h5") as file:
        assert listed("Attributes of the root") == set(file.attrs)
        assert listed("/provenance") == {*file["provenance"].attrs, INTERVENTION}  # which this run had none of


def test_the_smallest_scenario_is_one() -> None:
    text, sweep = re.findall(r"^```toml\n(.*?)^```$", generate_docs.read("scenarios.md"), re.MULTILINE | re.DOTALL)
    assert "[sweep]" in sweep
    assert loads(text).resolved()["sliding"]["distance"] == "2000 um"
    for key in ("mean_real_contact_area", "mean_junction_count", "distance"):
        assert key in text
