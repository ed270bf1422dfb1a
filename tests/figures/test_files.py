"""Files of figures, and the picture of a theory."""

import hashlib
import subprocess
import sys
from typing import Any

import numpy as np
import pytest

import rubnoise
from rubnoise.figures import style
from rubnoise.figures.style import FORMATS, Format, as_bytes, house_style, new_figure
from rubnoise.figures.theory import theory_figure
from rubnoise.model import Model
from tests.figures.test_run_pictures import of_colour, pixels_of

# Files of figures: what they are, and that they say nothing about when and by what they were made.
BEGINNINGS = {"png": b"\x89PNG\r\n\x1a\n", "pdf": b"%PDF-", "svg": b"<?xml"}
ANEW = """
import hashlib, sys
from tests.figures.test_files import FORMATS, drawn_as
print(*(hashlib.sha256(drawn_as(kind)).hexdigest() for kind in FORMATS))
"""


def drawn_as(kind: Format) -> bytes:
    with house_style():
        figure = new_figure(3.0, 2.0)
        axes = figure.subplots()
        axes.fill_between([0.0, 1.0], [1.0, 3.0], hatch="//", clip_on=True)
        axes.set_title("costs $5 of µm²")
        return as_bytes(figure, kind)


@pytest.mark.slow
def test_a_figure_is_the_same_in_another_process() -> None:
    done = subprocess.run([sys.executable, "-c", ANEW], capture_output=True, text=True, check=True)
    assert done.stdout.split() == [hashlib.sha256(drawn_as(kind)).hexdigest() for kind in FORMATS]


@pytest.mark.slow("pdf")
@pytest.mark.parametrize("kind", FORMATS)
def test_a_file_is_of_its_kind_and_names_no_date(kind: Format) -> None:
    picture = drawn_as(kind)
    assert picture.startswith(BEGINNINGS[kind])
    assert b"CreationDate" not in picture
    assert b"dc:date" not in picture
    assert b"atplotlib v" not in picture


# The picture of a scenario's theory.
CONTACT: dict[str, Any] = {
    "format": 1,
    "interface": {"mean_real_contact_area": 200.0, "mean_junction_count": 20},
    "sliding": {"distance": 100.0},
}
WITH_SLIDER = CONTACT | {
    "strength": {"mean": 250.0},
    "sliding": {"distance": 100.0, "speed": 1000.0},
    "slider": {"mass": 0.005, "stiffness": 300.0, "damping": 0.05},
}
RABINOWICZ = CONTACT | {"pulse": {"shape": "triangle"}, "birth": {"law": "regular"}}
FEW = CONTACT | {"interface": {"mean_real_contact_area": 20.0, "mean_junction_count": 0.05}}
WIDE = CONTACT | {"diameter": {"law": "normal", "spread": "150 %"}}
EVERY = {"contact": CONTACT, "slider": WITH_SLIDER, "rabinowicz": RABINOWICZ, "few": FEW, "wide": WIDE}


def _model(values: dict[str, Any]) -> Model:
    return rubnoise.build(values).model()


@pytest.mark.slow
@pytest.mark.parametrize("values", EVERY.values(), ids=EVERY)
def test_every_contact_has_a_picture_with_nothing_cut_off(values: dict[str, Any]) -> None:
    pixels = pixels_of(as_bytes(theory_figure(_model(values), "a contact")))
    border = np.concatenate([pixels[:2].reshape(-1, 3), pixels[-2:].reshape(-1, 3), pixels[:, :2].reshape(-1, 3)])
    assert np.all(border == 1.0)
    assert of_colour(pixels, style.VERMILION) > 300
