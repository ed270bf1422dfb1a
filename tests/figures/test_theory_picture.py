"""The picture of a scenario's theory."""

from io import BytesIO
from typing import Any

import matplotlib.image
import numpy as np
import pytest

import rubnoise
from rubnoise.figures import style
from rubnoise.figures.style import FORMATS, Format, house_style
from rubnoise.figures.theory import theory_figure, theory_picture
from rubnoise.model import Model

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


@pytest.mark.parametrize("values", EVERY.values(), ids=EVERY)
def test_every_contact_has_a_picture_with_nothing_cut_off(values: dict[str, Any]) -> None:
    png = theory_picture(_model(values), "a contact", "png")
    pixels = np.asarray(matplotlib.image.imread(BytesIO(png)))[:, :, :3]
    border = np.concatenate([pixels[:2].reshape(-1, 3), pixels[-2:].reshape(-1, 3), pixels[:, :2].reshape(-1, 3)])
    assert np.all(border == 1.0)
    wanted = [int(style.VERMILION[i : i + 2], 16) / 255.0 for i in (1, 3, 5)]
    assert np.all(np.abs(pixels - wanted) < 0.02, axis=2).sum() > 300


@pytest.mark.parametrize("kind", FORMATS)
def test_it_is_the_same_each_time(kind: Format) -> None:
    model = _model(WITH_SLIDER)
    assert theory_picture(model, "x", kind) == theory_picture(model, "x", kind)


def test_the_slider_is_drawn_where_there_is_one() -> None:
    with_slider, without = (theory_picture(_model(values), "x", "svg").decode() for values in (WITH_SLIDER, CONTACT))
    assert with_slider.count('id="axes_') == 4
    assert without.count('id="axes_') == 3


def test_a_contact_that_never_varies_says_so() -> None:
    with house_style():
        figure = theory_figure(_model(WITH_SLIDER | RABINOWICZ | {"sliding": WITH_SLIDER["sliding"]}), "Rabinowicz")
    told = [text.get_text() for axes in figure.axes for text in axes.texts]
    assert "always 200 µm²" in told
    assert told.count("nothing varies") == 2, "neither the area nor the slider"
