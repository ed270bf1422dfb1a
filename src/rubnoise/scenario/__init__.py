"""Scenario files: from TOML to a checked scenario, or to a list of all problems of the file.

A text becomes data with places, the layers of a file are merged, each key is checked, and then all keys together. Begin
with `document`, which has every key, then `reading`; a file that stands for many runs is read by `sweep`.
"""

from rubnoise.scenario.reading import build, load, loads
from rubnoise.scenario.scenario import Scenario
from rubnoise.scenario.written import json_schema

__all__ = ["Scenario", "build", "json_schema", "load", "loads"]
