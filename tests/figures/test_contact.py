"""The contact from above shows the junctions of a run where they overlap, and their areas."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import rubnoise
from rubnoise.analysis.junctions import Neighbours
from rubnoise.errors import Refused
from rubnoise.figures import contact
from rubnoise.figures.catalogue import drawing
from rubnoise.figures.contact import LEAD, MOST_AT_ONCE, Stage, stage_of
from rubnoise.figures.tracks import Stretch
from rubnoise.storage.reader import open_run

SCENARIO: dict[str, Any] = {
    "format": 1,
    "title": "a contact",
    "interface": {"mean_real_contact_area": 200.0, "mean_junction_count": 20},
    "diameter": {"law": "normal", "spread": "0.4 um"},
    "sliding": {"distance": 400.0},
    "output": {"tick": "0.1 um"},
}
AT = 150.0


@pytest.fixture(scope="module")
def stretch(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stretch]:
    path = tmp_path_factory.mktemp("contact") / "run.h5"
    rubnoise.run(rubnoise.build(SCENARIO), path, seed=3).close()
    with open_run(path) as file:
        yield Stretch.of(file)


@pytest.fixture(scope="module")
def stage(stretch: Stretch) -> Stage:
    return stage_of(stretch, AT)


def test_each_pair_has_a_place_of_its_own_inside_the_stage(stage: Stage) -> None:
    places = list(zip(stage.x.tolist(), stage.y.tolist(), strict=True))
    assert len(set(places)) == len(places) > 10
    reach = (1.5 + LEAD) * stage.junctions.diameter
    assert np.all(stage.y - 0.5 * stage.junctions.diameter > 0.0)
    assert np.all(stage.y + 0.5 * stage.junctions.diameter < stage.height)
    assert np.all(stage.x - reach > 0.0)
    assert np.all(stage.x + reach < stage.width)
    assert 1.2 < stage.width / stage.height < 4.0


def test_too_many_are_refused_and_none_are_drawn_too(
    stage: Stage, stretch: Stretch, monkeypatch: pytest.MonkeyPatch
) -> None:
    def alike(count: int) -> Neighbours:
        names = ("rows", "birth", "death", "diameter")
        return replace(
            stage.junctions, **{name: np.repeat(getattr(stage.junctions, name)[:1], count) for name in names}
        )

    for count in (MOST_AT_ONCE, 0):
        monkeypatch.setattr(contact, "neighbours", lambda *_, count=count: alike(count))
        assert stage_of(stretch, AT).x.size == count
    monkeypatch.setattr(contact, "neighbours", lambda *_: alike(MOST_AT_ONCE + 1))
    with pytest.raises(Refused, match="401 junctions are there at once, of which a picture shows 400 at most"):
        stage_of(stretch, AT)


def _overlap(apart: np.ndarray, diameter: np.ndarray) -> np.ndarray:
    """Return the area in which circles of a diameter overlap, if their centres are so far apart."""
    share = np.minimum(apart / diameter, 1.0)
    return 0.5 * diameter**2 * (np.arccos(share) - share * np.sqrt(1.0 - share**2))


def test_areas_in_the_picture_are_those_of_the_junctions(stretch: Stretch) -> None:
    figure = drawing("contact", Stretch.of(stretch.file, AT, AT + 10.0))
    axes = figure.axes[0]
    lower, upper = axes.collections
    overlaps = _overlap(np.hypot(*(upper.get_offsets() - lower.get_offsets()).T), lower.get_widths())
    row = round(AT / stretch.model.tick)
    assert overlaps.sum() == pytest.approx(stretch.file.column("trace", "real_contact_area", row, row + 1)[0])
    centres = {tuple(each.center) for each in axes.patches}
    assert centres == {tuple(each) for each in np.asarray(upper.get_offsets())[overlaps > 0.0].tolist()}
    assert all(each.get_clip_path() is not None for each in axes.patches)
    texts = {text.get_text() for text in axes.get_legend().get_texts()} | {figure.axes[1].get_ylabel()}
    assert {"birth", "death", "area of a junction (µm²)"} <= texts
