"""Pictures of a slider that rises and falls under its load: beside theory to first order, alone where it bounces."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rubnoise
from rubnoise.analysis.motion import Flights
from rubnoise.errors import Refused
from rubnoise.figures.catalogue import PICTURES, drawing
from rubnoise.figures.tracks import Stretch
from rubnoise.record.rows import ContactKind
from rubnoise.storage.reader import open_run
from rubnoise.theory.coupling import load_motion
from tests.architecture.sources import ROOT

LOAD = ROOT / "scenarios" / "load"
NO_AREA = {"lives", "overview", "contact"}
"""Pictures that need the area of every junction from place to place, which no touch says."""


def stretch_of(scenario: str, folder: Path, *changes: str) -> Iterator[Stretch]:
    path = folder / "run.h5"
    rubnoise.run(rubnoise.load(LOAD / f"{scenario}.toml", list(changes)), path).close()
    with open_run(path) as file:
        yield Stretch.of(file)


@pytest.fixture(scope="module")
def bouncing(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stretch]:
    """A light slider that hops, over 6 mm."""
    yield from stretch_of("bouncing", tmp_path_factory.mktemp("bouncing"), "sliding.distance=6 mm")


@pytest.fixture(scope="module")
def weighed(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stretch]:
    """A heavy one that rises and falls to first order, over 0.4 mm."""
    yield from stretch_of("fig5_load", tmp_path_factory.mktemp("weighed"), "sliding.distance=400 um")


@pytest.mark.parametrize("name", [name for name in PICTURES if name not in {"slider", "phase", *NO_AREA}])
def test_free_motion_is_drawn_without_a_theory_that_it_does_not_have(bouncing: Stretch, name: Any) -> None:
    labels = [label for axes in drawing(name, bouncing).axes for label in axes.get_legend_handles_labels()[1]]
    assert [label for label in labels if "exact" in label] == (["exact mean"] if name == "load" else [])


@pytest.mark.parametrize("name", sorted(NO_AREA))
def test_what_needs_the_area_of_a_touch_is_refused_in_words(bouncing: Stretch, name: Any) -> None:
    with pytest.raises(Refused, match="rows of free motion are touches, whose areas follow the separation"):
        drawing(name, bouncing)


@pytest.mark.slow
def test_the_spectrum_of_the_normal_velocity_follows_theory(weighed: Stretch) -> None:
    (ratio,) = [axes for axes in drawing("psd", weighed, heard="normal-velocity").axes if axes.get_ylabel() == "ratio"]
    (line,) = [line for line in ratio.lines if "over expected" in str(line.get_label())]
    place, value = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
    resonance = load_motion(weighed.model).contact_resonance
    assert abs(np.mean(value[place < 2.0 * resonance]) - 1.0) < 0.25
    assert place[0] < 0.1 * resonance


def test_flights_are_the_time_without_contact_and_impacts_end_them(bouncing: Stretch) -> None:
    file = bouncing.file
    end = float(file.column("load", "time", file.rows("load") - 1, file.rows("load"))[0])
    found = Flights.of(file, 0.0, end)
    count = file.column("trace", "junction_count", 0, file.rows("trace"))
    time = file.column("load", "time", 0, file.rows("load"))
    off = np.zeros(time.size, dtype=np.bool_)
    for begin, stop in zip(found.begin, found.end, strict=True):
        off |= (begin <= time) & (time < stop)
    assert np.mean(off != (count == 0)) < 1e-4
    assert abs(found.share(0.0, end) - np.mean(count == 0)) < 1e-3
    kind = file.column("landmarks", "kind", 0, file.rows("landmarks"))
    assert found.impacts.size == np.sum(kind == ContactKind.CONTACT_MADE)
    half = Flights.of(file, 0.0, 0.5 * end)
    rest = Flights.of(file, 0.5 * end, end)
    assert half.share(0.0, 0.5 * end) + rest.share(0.5 * end, end) == pytest.approx(2.0 * found.share(0.0, end))
    assert half.impacts.size + rest.impacts.size == found.impacts.size


def test_the_share_apart_stands_over_the_histogram_of_the_load(bouncing: Stretch) -> None:
    count = bouncing.file.column("trace", "junction_count")
    title = str(drawing("histogram", bouncing, heard="load").get_suptitle()).replace("\n", " ")
    share = float(title.partition("off the surface for ")[2].partition(" %")[0])
    assert abs(share - 100.0 * np.mean(count == 0)) < 0.2
