"""Scenario files: TOML in, a checked scenario or every problem of the file at once out."""

from rubnoise.scenario.reading import build, load, loads
from rubnoise.scenario.scenario import Scenario
from rubnoise.scenario.schema import json_schema

__all__ = ["Scenario", "build", "json_schema", "load", "loads"]
