"""Files of figures, the picture of a theory, and the picture of the README."""

import hashlib
import subprocess
import sys
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib.image
import numpy as np
import pytest

import rubnoise
from rubnoise.errors import Refused
from rubnoise.figures import style
from rubnoise.figures.overview import overview_figure
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.style import FORMATS, Format, as_bytes, as_png, house_style, new_figure
from rubnoise.figures.theory import theory_picture
from rubnoise.model import Model
from rubnoise.storage.reader import open_run

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
    png = theory_picture(_model(values), "a contact", "png")
    pixels = np.asarray(matplotlib.image.imread(BytesIO(png)))[:, :, :3]
    border = np.concatenate([pixels[:2].reshape(-1, 3), pixels[-2:].reshape(-1, 3), pixels[:, :2].reshape(-1, 3)])
    assert np.all(border == 1.0)
    wanted = [int(style.VERMILION[i : i + 2], 16) / 255.0 for i in (1, 3, 5)]
    assert np.all(np.abs(pixels - wanted) < 0.02, axis=2).sum() > 300


# The picture of the README.
ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    pytest.importorskip("matplotlib")
    scenario = rubnoise.load(ROOT / "scenarios" / "paper" / "fig5.toml", ["sliding.distance=500 um"])
    path = tmp_path_factory.mktemp("overview") / "run.h5"
    rubnoise.run(scenario, path).close()
    with open_run(path) as opened:
        yield Stretch.of(opened)


def overview(stretch, number):
    with house_style():
        return as_png(overview_figure(stretch, number))


def test_a_junction_that_is_not_there_is_refused(run):
    with pytest.raises(Refused, match="100000"):
        overview(run, 100_000)
