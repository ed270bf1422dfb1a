"""The schema on file is the schema of the code, and says what is available and needed."""

import json
import tomllib
from pathlib import Path

import pytest

from rubnoise.contact.laws import LAWS
from rubnoise.scenario import json_schema, load
from rubnoise.scenario.document import Document
from rubnoise.scenario.keys import SECTIONS
from rubnoise.scenario.sweep import load_either
from rubnoise.scenario.sweep_table import Sweeping

SCENARIOS = Path(__file__).parents[2] / "scenarios"


def test_the_schema_on_file_is_that_of_the_code() -> None:
    on_file = json.loads((SCENARIOS / "scenario.schema.json").read_text(encoding="utf-8"))
    assert on_file == json_schema(), "rubnoise schema > scenarios/scenario.schema.json"


def test_every_key_is_described() -> None:
    for name, section in json_schema()["$defs"].items():
        assert section["additionalProperties"] is False, name
        assert all(about["description"] for about in section["properties"].values())


def test_the_schema_offers_what_is_available_and_no_more() -> None:
    sections = json_schema()["$defs"]
    assert sections["Diameter"]["properties"]["law"]["enum"] == list(LAWS)
    assert sections["Run"]["properties"]["engine"]["enum"] == ["events", "batch"]


def test_needed_keys_are_demanded_unless_another_file_may_have_them() -> None:
    schema = json_schema()
    assert schema["required"] == ["format"]
    assert schema["if"] == {"not": {"anyOf": [{"required": ["extends"]}, {"required": ["sweep"]}]}}
    assert schema["then"]["required"] == ["interface", "sliding"]
    assert schema["then"]["properties"]["sliding"] == {"required": ["distance"]}
    assert schema["then"]["dependentSchemas"]["slider"]["required"] == ["strength"]
    assert not any("required" in section for section in schema["$defs"].values())


@pytest.mark.parametrize("path", sorted(SCENARIOS.rglob("*.toml")), ids=lambda path: path.stem)
def test_a_scenario_of_the_project_names_its_schema_and_loads_without_a_warning(path: Path) -> None:
    first = path.read_text(encoding="utf-8").splitlines()[0]
    assert (path.parent / first.removeprefix("#:schema ")).resolve() == SCENARIOS / "scenario.schema.json"
    assert load_either(path).warnings == ()
    assert set(tomllib.loads(path.read_text(encoding="utf-8"))) <= {*Document.model_fields, "extends", "sweep"}


def test_the_schema_of_a_sweep_takes_lists_of_what_each_key_takes() -> None:
    schema = json_schema()
    sweep = schema["properties"]["sweep"]["properties"]
    assert set(sweep) == {*Sweeping.model_fields, "grid", "zip"}
    for table in (sweep["grid"], sweep["zip"]):
        swept = {
            f"{name}.{key}": about
            for name, keys in table["properties"].items()
            for key, about in keys["properties"].items()
        }
        assert set(swept) == {f"{name}.{key}" for name, section in SECTIONS.items() for key in section.model_fields} - {
            "run.seed"
        }
        for about in swept.values():
            *_, section, properties, key = about["items"]["$ref"].split("/")
            assert schema["$defs"][section][properties][key]


def test_the_papers_figure_5_has_the_papers_numbers() -> None:
    model = load(SCENARIOS / "paper" / "fig5.toml").model()
    assert model.calibrated_diameter == pytest.approx(5.5300126, abs=5e-8)
    assert model.stationary_mean_area == pytest.approx(204.6736, abs=5e-5)
    assert model.equilibrium_displacement == pytest.approx(170.561, abs=5e-4)
    assert model.slider is not None
    assert model.slider.natural_frequency == pytest.approx(38.985, abs=5e-4)
    assert model.slider.damping_ratio == pytest.approx(0.02041, abs=5e-6)
    assert (model.distance, model.tick, model.tick_count) == (20_000.0, 0.1, 200_000)


def test_the_scenarios_of_figure_6_differ_in_the_number_of_junctions_and_are_runs_of_their_own() -> None:
    models = [load(SCENARIOS / "paper" / f"fig6_n{n}.toml").resolved() for n in (10, 20, 30, 40, 50)]
    counts = [model["interface"].pop("mean_junction_count") for model in models]
    titles = {model.pop("title") for model in models}
    seeds = {model["run"].pop("seed") for model in models}
    assert counts == [10, 20, 30, 40, 50]
    assert len(seeds) == 5
    assert len(titles) == 5
    assert all(model == models[0] for model in models)
