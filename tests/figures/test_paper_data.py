"""What the figures of the paper are drawn from: thinned curves, spreads with intervals, binned spectra."""

from pathlib import Path

import numpy as np
import pytest

from rubnoise.analysis.spectra import Spectrum
from rubnoise.figures import paper_spread
from rubnoise.figures.paper_sources import Sources, envelope
from rubnoise.figures.paper_spectra import FIRST, WIDEST, merged_bins
from rubnoise.figures.paper_spread import Spread, spreads_of
from rubnoise.scenario.sweep import load_sweep
from tests.figures.papers import PAPER
from tests.verification.seeds import seed_of


def test_a_thinned_curve_keeps_its_extremes() -> None:
    place = np.arange(100_000.0)
    value = np.sin(place) * np.exp(-((place - 3e4) ** 2) / 1e9)
    x, y = envelope(place, value, 1000)
    assert x.size == y.size <= 1000
    assert (y.min(), y.max()) == (value.min(), value.max())
    assert np.all(np.diff(x) >= 0.0)
    for each in range(0, x.size, 2):
        inside = value[(place >= x[each]) & (place < x[each] + 200)]
        assert (y[each], y[each + 1]) == (inside.min(), inside.max())


def test_a_short_curve_is_drawn_as_it_is() -> None:
    place = np.arange(100.0)
    x, y = envelope(place, place**2, 200)
    assert np.array_equal(x, place)
    assert np.array_equal(y, place**2)


def test_bins_of_a_spectrum_keep_its_integral() -> None:
    wavenumber = np.arange(5001) * 0.006
    density = 1.0 / (1.0 + wavenumber**4)
    seen = Spectrum(wavenumber=wavenumber, density=density, standard_error=density, ticks=10_000, segments=50)
    places, means = merged_bins(seen)
    assert places[0] == wavenumber[FIRST]
    assert places.size < 500
    assert np.all(np.diff(places) > 0.0)
    assert np.diff(places).max() <= 1.5 * WIDEST
    assert np.abs(means * (1.0 + places**4) - 1.0).max() < 0.02
    widths = np.diff(np.searchsorted(wavenumber, [*places[:3], np.inf]))
    assert list(widths[:2]) == [1, 1]


@pytest.fixture(scope="module")
def spreads(tmp_path_factory: pytest.TempPathFactory) -> list[Spread]:
    folder = tmp_path_factory.mktemp("fig7")
    lines = ["format = 1", f'extends = "{PAPER / "fig7.toml"}"', "[run]", f"seed = {seed_of('spreads of figure 7')}"]
    lines += ["[sliding]", 'distance = "3 mm"', "[sweep]", "replicates = 2", "[sweep.grid]"]
    lines += ['interface.mean_real_contact_area = ["100 um^2", "300 um^2"]']
    lines += ["interface.mean_junction_count = [10, 20, 30]"]
    (folder / "fig7.toml").write_text("\n".join([*lines, ""]), encoding="utf-8")
    return spreads_of(Sources(folder=folder), "fig7.toml")


def _z(spreads: list[Spread], factor: float) -> np.ndarray:
    return np.array([(each.std - factor * each.exact_std) / each.standard_error for each in spreads])


def test_spreads_lie_about_the_exact_ones_by_their_errors(spreads: list[Spread]) -> None:
    assert [spread.count for spread in spreads] == [10, 20, 30] * 2
    z = _z(spreads, 1.0)
    assert np.abs(z).max() <= 4.0
    assert 0.3 < np.square(z).sum() < 27.0  # chi-squared of 6: outside in fewer than 1 of 1000 on either side
    assert np.abs(_z(spreads, 1.15)).max() > 4.0  # what is 15 % off is noticed


def test_four_replicates_halve_the_error_of_one(tmp_path: Path) -> None:
    errors = []
    for replicates in (1, 4):
        (tmp_path / "fig7.toml").write_text(
            f'format = 1\nextends = "{PAPER / "fig7.toml"}"\n[sliding]\ndistance = "300 um"\n[sweep]\n'
            f"replicates = {replicates}\n[sweep.grid]\ninterface.mean_junction_count = [10]\n"
            'interface.mean_real_contact_area = ["100 um^2"]\n',
            encoding="utf-8",
        )
        (spread,) = spreads_of(Sources(folder=tmp_path), "fig7.toml")
        errors.append(spread.standard_error)
    assert errors[0] == pytest.approx(2.0 * errors[1], rel=1e-12)


def test_the_law_is_that_of_one_size() -> None:
    assert pytest.approx(1.2298, abs=5e-5) == paper_spread.LAW


def test_figure_7_takes_every_point_and_replicate() -> None:
    sweep = load_sweep(PAPER / "fig7.toml")
    assert (len(sweep.cases), sweep.replicates) == (25, 4)


def test_runs_are_counted_aloud(tmp_path: Path) -> None:
    (tmp_path / "fig7.toml").write_text(
        f'format = 1\nextends = "{PAPER / "fig7.toml"}"\n[sliding]\ndistance = "50 um"\n[sweep]\nreplicates = 1\n'
        "[sweep.grid]\ninterface.mean_junction_count = [10]\n",
        encoding="utf-8",
    )
    told: list[tuple[int, int]] = []
    spreads_of(Sources(folder=tmp_path, watch=lambda done, runs: told.append((done, runs))), "fig7.toml")
    assert told == [(done, 5) for done in range(1, 6)]
