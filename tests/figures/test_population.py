"""Histograms of single junctions beside their laws, the contact from above, and how pictures look."""

from typing import Any

import numpy as np
import pytest

import rubnoise
from rubnoise.figures.pictures import born
from rubnoise.figures.tracks import Stretch
from rubnoise.storage.reader import open_run
from rubnoise.theory.moments import share_of

SCENARIO: dict[str, Any] = {
    "format": 1,
    "interface": {"mean_real_contact_area": 200.0, "mean_junction_count": 20, "calibration": "exact"},
    "diameter": {"law": "normal", "spread": "0.8 um"},
    "sliding": {"distance": 4000.0, "speed": 1000.0},
    "slider": {"mass": 0.005, "stiffness": 300.0, "damping": 0.05},
    "strength": {"mean": 250.0},
    "output": {"tick": "0.2 um"},
}
KINDS = {
    "poisson": SCENARIO,
    "gamma": SCENARIO | {"birth": {"law": "gamma", "shape": 4.0}},
    "off the centre": SCENARIO | {"pulse": {"offset": "uniform"}},
}


@pytest.fixture(scope="module", params=KINDS)
def stretch(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Any:
    path = tmp_path_factory.mktemp("population") / "run.h5"
    rubnoise.run(rubnoise.build(KINDS[request.param]), path, seed=5).close()
    with open_run(path) as file:
        yield Stretch.of(file)


def scores(values: Any, edges: Any, law: Any) -> Any:
    """How many standard errors of a binomial count each bin lies off."""
    counts = np.histogram(values, edges)[0]
    error = np.sqrt(values.size * law * (1.0 - law))
    return (counts - values.size * law)[error > 3.0] / error[error > 3.0]


@pytest.mark.slow("gamma", "off the centre")
def test_histograms_are_those_of_the_laws_and_not_of_others(stretch: Stretch) -> None:
    sizes, model = born(stretch, "diameter"), stretch.model
    lives = born(stretch, "death_distance") - born(stretch, "birth_distance")
    gaps = np.diff(born(stretch, "birth_distance"))
    by_size, by_life = np.linspace(0.0, 10.0, 30), np.linspace(0.0, 20.0, 30)
    by_gap = np.linspace(0.0, 5.0 * model.births.mean_spacing, 30)
    shares = share_of("gaps", model, by_gap)
    assert shares is not None
    assert np.abs(scores(sizes, by_size, share_of("sizes", model, by_size))).max() < 4.0
    assert np.abs(scores(lives, by_life, share_of("lives", model, by_life))).max() < 4.0
    assert np.abs(scores(gaps, by_gap, shares)).max() < 4.0
    # Controls: sizes and lives 5 % larger, and gaps of another law.
    assert np.abs(scores(1.05 * sizes, by_size, share_of("sizes", model, by_size))).max() > 6.0
    assert np.abs(scores(1.05 * lives, by_life, share_of("lives", model, by_life))).max() > 4.0
    assert np.abs(scores(np.full(gaps.size, model.births.mean_spacing), by_gap, shares)).max() > 6.0
