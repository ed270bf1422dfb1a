"""Long runs against exact theory: every contact of the paper's figures, the slider of Fig. 5, and faults that show."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from simpy import Environment
from simpy.events import ProcessGenerator

from rubnoise.contact.births import PoissonBirths
from rubnoise.contact.laws import Normal, Spread
from rubnoise.model import Model
from rubnoise.record.tally import Tally
from rubnoise.scenario import load
from rubnoise.simulation import junctions
from rubnoise.simulation.run import simulate
from rubnoise.theory.motion_errors import mean_force_error, motion_errors
from rubnoise.theory.sampling import standard_errors
from tests.models import bare, recorded
from tests.verification.scores import (
    BOUND,
    PRECISION,
    REJECTED,
    errors_of,
    expected,
    mean_score,
    measured,
    outside,
    reference_model,
    relative_errors,
    scores,
)
from tests.verification.seeds import seed_of

ROOT = Path(__file__).parents[2]
TABLE = json.loads((ROOT / "tests" / "reference" / "moments.json").read_text(encoding="utf-8"))["rows"]
ROWS = [row for row in TABLE if row["calibration"] == "paper"]
FIGURES = ("area_mean", "area_std", "area_skewness", "area_excess_kurtosis", "junction_count_mean")
SHORT_RUNS = 400


def label(row: dict[str, Any]) -> str:
    keys = ("mean_real_contact_area_input", "mean_junction_count_input", "diameter_std")
    return "-".join(f"{row[key]}" for key in keys)


@pytest.mark.parametrize("row", ROWS, ids=label)
def test_a_run_has_the_moments_of_the_reference(row: dict[str, Any]) -> None:
    model = reference_model(row)
    assert max(relative_errors(model, row)) <= PRECISION
    values = {name: row[name] for name in FIGURES}
    assert not outside(scores(measured(model, seed_of(f"reference/{label(row)}")), values, errors_of(model)))


def test_figure_5_over_200_mm() -> None:
    scenario = load(
        ROOT / "scenarios" / "paper" / "fig5.toml",
        overrides=('sliding.distance="200 mm"', 'output.tick="0.4 um"'),
    )
    model, tally = scenario.model(), Tally()
    simulate(model, seed_of("figure 5"), tally)
    area, motion = standard_errors(model), motion_errors(model, model.distance)
    moments = tally.moments
    found = {
        "area mean": (moments["real_contact_area"].mean, 204.6736, area.mean),
        "area std": (moments["real_contact_area"].std, 56.4294, area.std),
        "mean force in mN": (moments["friction_force"].mean / 1e3, 51.168, mean_force_error(model) / 1e3),
        "mean displacement": (moments["displacement"].mean, 170.561, motion.mean_displacement),
        "displacement std": (moments["displacement"].std, 195.3059, motion.displacement_std),
        "velocity std in mm/s": (moments["velocity"].std / 1e3, 47.2411, motion.velocity_std / 1e3),
    }
    # A run of 200 mm knows these figures well: a bound that nothing can miss would show nothing.
    assert all(error < 0.03 * value for _, value, error in found.values())
    assert not outside({name: (seen - value) / error for name, (seen, value, error) in found.items()})


# Faults that the same machinery has to reject.


@pytest.fixture(scope="module")
def precise() -> Model:
    """Return a contact of 800 000 junctions, which tells a hundredth in their number."""
    return bare(count=200.0, distance=14_000.0, tick=0.25)


def test_a_life_mean_of_0_327_is_rejected(precise: Model) -> None:
    found = scores(measured(precise, seed_of("precise")), expected(precise), errors_of(precise))
    assert not outside(found)
    away = (1.0 - 0.327 * 3.0) * expected(precise)["area_mean"] / errors_of(precise)["area_mean"]
    assert found["area_mean"] + away > REJECTED


def test_births_a_hundredth_too_rare_are_rejected(precise: Model) -> None:
    wrong = replace(precise, births=PoissonBirths(mean_spacing=1.01 * precise.births.mean))
    found = scores(measured(wrong, seed_of("rare births")), expected(precise), errors_of(precise))
    assert found["junction_count_mean"] < -REJECTED


def test_death_at_1_98_diameters_is_rejected(precise: Model, monkeypatch: pytest.MonkeyPatch) -> None:
    live_on = junctions.junction

    def shorter(env: Environment, live: junctions.LiveSet, row: int, death: float, rest: float) -> ProcessGenerator:
        birth = death - 2.0 * float(live._rows.diameter[row])
        death = birth + 0.99 * (death - birth)
        yield from live_on(env, live, row, death, max(min(rest, death - env.now), 0.0))

    monkeypatch.setattr(junctions, "junction", shorter)
    found = scores(measured(precise, seed_of("early death")), expected(precise), errors_of(precise))
    assert found["junction_count_mean"] < -REJECTED


class PlainStart(Normal):
    """Sizes of which the contact at the start is drawn as if every junction were as likely to be met."""

    __slots__ = ()

    def draw_length_biased(self, generator: np.random.Generator, count: int) -> np.ndarray:
        return self.draw(generator.random(count))


def short_means(model: Model, name: str) -> list[float]:
    """Return the mean area of short runs that differ in their seeds."""
    seeds = range(seed_of(name), seed_of(name) + SHORT_RUNS)
    return [float(recorded(model, seed)["trace"]["real_contact_area"].mean()) for seed in seeds]


WIDE = bare(spread=Spread(absolute=4.0), distance=3.0, tick=0.5)


def test_short_runs_from_a_stationary_start_have_the_mean_at_once() -> None:
    z = mean_score(short_means(WIDE, "short"), expected(WIDE)["area_mean"], standard_errors(WIDE).mean)
    assert abs(z) <= BOUND


def test_a_start_from_nothing_is_not_stationary() -> None:
    empty = short_means(replace(WIDE, start="empty"), "short from empty")
    assert mean_score(empty, expected(WIDE)["area_mean"], standard_errors(WIDE).mean) < -REJECTED


def test_a_start_with_sizes_as_they_are_born_is_not_stationary() -> None:
    law = WIDE.sizes
    assert isinstance(law, Normal)
    wrong = replace(WIDE, sizes=PlainStart(centre=law.centre, std=law.std))
    z = mean_score(short_means(wrong, "unbiased"), expected(WIDE)["area_mean"], standard_errors(WIDE).mean)
    assert z < -REJECTED
