"""Long runs against exact theory: the paper's figures, and passes off the centre line."""

import json
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rubnoise
from rubnoise.analysis.comparison import compare
from rubnoise.analysis.findings import Comparison
from rubnoise.analysis.measured import Measured
from rubnoise.contact.laws import Spread
from rubnoise.contact.pulses import LENS, OFF_CENTRE_LENS, OFF_CENTRE_PARABOLA, PARABOLA, Pulse, area_of
from rubnoise.model import Model, Slider
from rubnoise.record.rows import MemoryRecord
from rubnoise.scenario import load
from rubnoise.simulation import draws
from rubnoise.simulation.run import simulate
from rubnoise.streams import Stream, uniforms
from rubnoise.theory.moments import area_cumulants
from rubnoise.theory.motion import response
from rubnoise.theory.sampling import mean_force_error, motion_errors, standard_errors
from tests.laws.scores import (
    PRECISION,
    REJECTED,
    errors_of,
    measured,
    outside,
    reference_model,
    relative_errors,
    scores,
    seed_of,
)
from tests.models import bare, model, recorded
from tests.unit.tampering import run_of

# Long runs against exact theory: every contact of the paper's figures, the slider of Fig. 5, and faults that show.
ROOT = Path(__file__).parents[2]
TABLE = json.loads((ROOT / "tests" / "reference" / "moments.json").read_text(encoding="utf-8"))["rows"]
ROWS = [row for row in TABLE if row["calibration"] == "paper"][::6]
FIGURES = ("area_mean", "area_std", "area_skewness", "area_excess_kurtosis", "junction_count_mean")


def label(row: dict[str, Any]) -> str:
    keys = ("mean_real_contact_area_input", "mean_junction_count_input", "diameter_std")
    return "-".join(f"{row[key]}" for key in keys)


@pytest.mark.slow
@pytest.mark.parametrize("row", ROWS, ids=label)
def test_a_run_has_the_moments_of_the_reference(row: dict[str, Any]) -> None:
    model = reference_model(row)
    assert max(relative_errors(model, row)) <= PRECISION
    values = {name: row[name] for name in FIGURES}
    assert not outside(scores(measured(model, seed_of(f"reference/{label(row)}")), values, errors_of(model)))


# Runs off the centre line: their theory accepts them, and rejects what is wrong in one way.
ORDINARY = bare(pulse=OFF_CENTRE_LENS, distance=60_000.0, tick=0.5)
MOVING = model(
    pulse=OFF_CENTRE_LENS, distance=30_000.0, tick=0.5, slider=Slider(mass=0.005, stiffness=300.0, damping=0.5)
)
"""Damped well enough for many of its decays."""
ROUGH = bare(pulse=OFF_CENTRE_PARABOLA, distance=60_000.0, tick=0.5)


@cache
def played(run: Model) -> MemoryRecord:
    return recorded(run, seed_of("off centre"), engine="batch")


@cache
def compared(run: Model, with_theory_of: Model | None = None) -> Comparison:
    return compare(with_theory_of or run, played(run))


def scores_off_centre(found: Comparison) -> dict[str, float]:
    return {figure.name: figure.z for figure in found.figures if figure.z is not None}


@pytest.mark.slow
@pytest.mark.parametrize("run", [ORDINARY, MOVING, ROUGH], ids=["contact", "slider", "parabola"])
def test_a_run_is_accepted_by_its_theory(run: Model) -> None:
    found = compared(run)
    assert found.outside == ()
    assert {
        "offset_kolmogorov", "real_contact_area_mean", "real_contact_area_std", "real_contact_area_kolmogorov",
        "start_count",
    } <= scores_off_centre(found).keys()  # fmt: skip
    if run is MOVING:
        assert {"displacement_mean", "displacement_std", "velocity_std"} <= scores_off_centre(found).keys()
    else:
        assert sum(name.startswith("spectrum") for name in scores_off_centre(found)) == 8


@pytest.mark.slow
@pytest.mark.parametrize(("run", "through"), [(ORDINARY, LENS), (ROUGH, PARABOLA)], ids=["lens", "parabola"])
def test_the_theory_of_centred_passes_rejects_it(run: Model, through: Pulse) -> None:
    """The control: centred passes of the same mean life and births, as many and as large."""
    found = compared(run, replace(run, pulse=through))
    assert scores_off_centre(found)["real_contact_area_mean"] < -REJECTED
    bands = [z for name, z in scores_off_centre(found).items() if name.startswith("spectrum")]
    assert bands[-1] < -REJECTED


def test_the_spread_is_that_of_the_reference_and_not_of_centred_passes() -> None:
    """1.3559/sqrt(N) against 1.2298/sqrt(N), for equal sizes."""
    one_size = bare(pulse=OFF_CENTRE_LENS, spread=Spread(absolute=0.0), distance=60_000.0, tick=0.5)
    found, count = compared(one_size), one_size.mean_junction_count
    spread = area_cumulants(one_size).std / area_cumulants(one_size).mean * count**0.5
    assert spread == pytest.approx(1.3559061234577148, rel=1e-9)
    (std,) = (figure for figure in found.figures if figure.name == "real_contact_area_std")
    assert abs(std.z or 0.0) <= 4.0
    centred = std.exact * 1.2298 / 1.3559
    assert (std.value - centred) / std.error > REJECTED


def test_other_offsets_are_rejected(monkeypatch: pytest.MonkeyPatch) -> None:
    """One per cent of the passes on the other side of the line, lives right all the same: the offsets know."""

    def of_one_side(seed: int, stream: Stream, block: int, count: int) -> Any:
        uniform = uniforms(seed, stream, block, count)
        return np.where((stream is Stream.OFFSETS) & (uniform < 0.01), 1.0 - uniform, uniform)

    monkeypatch.setattr(draws, "uniforms", of_one_side)
    run = bare(pulse=OFF_CENTRE_LENS, distance=60_000.0, tick=5.0)
    found = compare(run, recorded(run, seed_of("off centre, other side"), engine="batch"))
    assert scores_off_centre(found)["offset_kolmogorov"] > REJECTED


def test_the_start_has_more_of_long_lives() -> None:
    """Of those alive b/d has the variance of a semicircle, 1/4; of those born that of a uniform number, 1/3."""
    run = bare(pulse=OFF_CENTRE_LENS, count=20_000.0, distance=1.0, tick=0.1)
    rows = played(run)["junctions"]
    there = np.signbit(rows["birth_distance"])
    square = np.square(rows["lateral_offset"] / rows["diameter"])[there]
    error = (1.0 / 8.0 - 1.0 / 16.0) ** 0.5 / square.size**0.5
    assert abs(square.mean() - 0.25) / error <= 4.0
    assert abs(square.mean() - 1.0 / 3.0) / error > REJECTED
    share = -rows["birth_distance"][there] / rows["life_distance"][there]
    assert abs(share.mean() - 0.5) * (12.0 * share.size) ** 0.5 <= 4.0


@pytest.mark.slow
def test_rows_are_what_the_offset_says() -> None:
    rows = played(ORDINARY)["junctions"]
    d, b = rows["diameter"], rows["lateral_offset"]
    assert np.all(np.abs(b) < d)
    assert rows["life_distance"] == pytest.approx(2.0 * np.sqrt(d * d - b * b), rel=1e-9)
    assert np.array_equal(rows["death_distance"], rows["birth_distance"] + rows["life_distance"])
    r = np.abs(b) / d
    assert rows["max_area"] == pytest.approx(d * d * 0.5 * (np.arccos(r) - r * np.sqrt(1.0 - r * r)), abs=1e-9)


def test_the_motion_is_as_right_at_coarse_ticks_as_at_fine_ones() -> None:
    """The births are the same whatever the ticks: so is the displacement, to 1e-9 of the largest."""
    coarse = model(pulse=OFF_CENTRE_LENS, distance=2_000.0, tick=2.0, speed=10_000.0)
    fine = replace(coarse, tick=0.125, tick_count=16_000)
    one, other = (recorded(run, 7, engine="batch")["slider"]["displacement"] for run in (coarse, fine))
    largest = np.abs(other).max()
    assert np.abs(one - other[::16]).max() < 1e-9 * largest
    shifted = recorded(replace(coarse, sliding_speed=10_000.001), 7, engine="batch")["slider"]["displacement"]
    assert np.abs(shifted - other[::16]).max() > 1e-9 * largest
    assert np.abs(one).max() < 100.0 * response(coarse).displacement_std


TABLES = {
    "pulse": {"offset": "uniform"},
    "interface": {"mean_real_contact_area": "200 um^2", "mean_junction_count": 20},
}


def test_the_table_gives_any_area_by_interpolation(tmp_path: Path) -> None:
    from scipy.interpolate import RegularGridInterpolator

    with rubnoise.open(run_of(tmp_path / "off.h5", **TABLES)) as run:
        assert "life_curve" not in run.groups()
        u, aside, area = (run.groups()["life_table"][name][:] for name in ("u", "offset_fraction", "area_fraction"))
        size = int(np.count_nonzero(u == u[0]))
        look = RegularGridInterpolator((u[::size], aside[:size]), area.reshape(-1, size))
        rows = {name: run.junctions[name][:200] for name in run.junctions}
    d, b = rows["diameter"], rows["lateral_offset"]
    for share in (0.05, 0.5, 1.0, 1.7):
        age = 0.5 * share * rows["life_distance"]
        off = look((np.full(d.size, share), np.abs(b) / d)) - area_of(OFF_CENTRE_LENS, age, d, b) / (d * d)
        assert np.abs(off).max() < 1e-3
    assert area.max() == pytest.approx(np.pi / 4.0)


@pytest.mark.slow
def test_figure_5_over_200_mm() -> None:
    scenario = load(
        ROOT / "scenarios" / "paper" / "fig5.toml",
        overrides=('sliding.distance="200 mm"', 'output.tick="0.4 um"'),
    )
    model = scenario.model()
    seen = Measured(model)
    simulate(model, seed_of("figure 5"), seen)
    area, motion = standard_errors(model), motion_errors(model, model.distance)
    moments = {name: found for (_, name), found in seen.moments.items()}
    found = {
        "area mean": (moments["real_contact_area"].mean, 204.6736, area["mean"]),
        "area std": (moments["real_contact_area"].std, 56.4294, area["std"]),
        "mean force in mN": (moments["friction_force"].mean / 1e3, 51.168, mean_force_error(model) / 1e3),
        "mean displacement": (moments["displacement"].mean, 170.561, motion["mean_displacement"]),
        "displacement std": (moments["displacement"].std, 195.3059, motion["displacement_std"]),
        "velocity std in mm/s": (moments["velocity"].std / 1e3, 47.2411, motion["velocity_std"] / 1e3),
    }
    # A run of 200 mm knows these figures well: a bound that nothing can miss would show nothing.
    assert all(error < 0.03 * value for _, value, error in found.values())
    assert not outside({name: (seen - value) / error for name, (seen, value, error) in found.items()})
