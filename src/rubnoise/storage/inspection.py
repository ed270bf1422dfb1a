"""The structure of a part file compared, name by name, with the structure that its own description gives.

A part found on the disk may be damaged, or made by anybody, in what no row and no hash covers: units, names, meanings,
links between columns, a group too many.
"""

import json
from collections.abc import Iterator
from itertools import islice
from typing import Final

from rubnoise.errors import RunFileRefused
from rubnoise.storage.inventory import OF_HDF5, Inventory, expected_inventory
from rubnoise.storage.reader import RunFile, refusing
from rubnoise.storage.run_description import description_of
from rubnoise.storage.schema import HASH

ELSEWHERE: Final = frozenset({"/ attribute source", f"/provenance attribute {HASH}"})
"""Attributes that say which version of the program began a run, and the hash that goes with them: checked by value."""


def check_structure(run: RunFile) -> None:
    """Raise RunFileRefused if anything of a part's structure is missing, too many or other than the program makes it.

    Its ``structure`` is that of before the inspection, so that any later change of it shows.
    """
    _ = run.structure
    ending = None
    if finished := str(run.provenance["finished"]):
        names = [(group, name) for group, columns in run.columns.items() for name in columns]
        ending = {each: run.digest(*each) for each in names}, run.summary, finished
    expected = expected_inventory(description_of(run), compressed=run.is_compressed, ending=ending)
    with refusing(run.path):
        if wrong := list(islice(_differences(run.inventory(), expected), 3)):
            raise RunFileRefused(f"damaged: {'; '.join(wrong)}")


def _differences(there: Inventory, right: Inventory) -> Iterator[str]:
    """Yield where a file is not what is made of its own description, rows left out of account."""
    found, expected = dict(_places(there)), dict(_places(right))
    for place in sorted({*found, *expected}):
        if place not in found:
            yield f"{place} is missing"
        elif place not in expected:
            yield f"{place} belongs to no run"
        elif found[place] != expected[place] and place not in ELSEWHERE:
            yield f"{place} is not that of a run"


def _places(objects: Inventory) -> Iterator[tuple[str, str]]:
    """Yield how each object is stored, and each of its attributes; as JSON, in which nan is nan, and -0 is not 0."""
    for path, about in objects.items():
        yield path, json.dumps({name: value for name, value in about.items() if name != "attributes"})
        for name, attribute in about["attributes"].items():
            yield f"{path} attribute {name}", json.dumps(attribute["value"] if name in OF_HDF5 else attribute)
