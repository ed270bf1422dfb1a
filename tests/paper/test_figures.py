"""Figures 2 to 9 of the paper: what they show, what they are drawn from, and their files."""

import re
from functools import cache
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib as mpl
import matplotlib.image
import numpy as np
import paper.__main__ as program
import pytest
from paper.figures import FIGURES, Sources, chosen, paper_figure
from paper.spectra import FIRST, WIDEST, Spot, merged_bins, spreads_of

from rubnoise.errors import Refused
from rubnoise.figures import style
from rubnoise.scenario.sweep import load_sweep
from rubnoise.theory.moments import area_cumulants
from rubnoise.theory.sampling import EstimatedSpectrum
from tests.figures.papers import PAPER, of_colour, short_papers
from tests.laws.scores import seed_of

pytestmark = pytest.mark.slow

NAMES = [f"fig{number}" for number in range(2, 10)]


@pytest.fixture(scope="module")
def drawn(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """Return what draws a figure once in all formats, from short scenarios."""
    sources = Sources(folder=short_papers(tmp_path_factory.mktemp("papers")))
    return cache(lambda name: paper_figure(name, style.FORMATS, sources))


def _pixels(png: bytes) -> np.ndarray:
    return np.asarray(matplotlib.image.imread(BytesIO(png)))[:, :, :3]


def test_the_figures_are_those_of_the_paper() -> None:
    assert list(FIGURES) == NAMES


@pytest.mark.parametrize("name", NAMES)
def test_a_figure_is_whole(drawn: Any, name: str) -> None:
    pixels = _pixels(drawn(name)["png"])
    assert pixels.shape[1] == 7.2 * style.DOTS_PER_INCH
    edges = [pixels[:3], pixels[-3:], pixels[:, :3], pixels[:, -3:]]
    assert all(np.all(edge == 1.0) for edge in edges)
    assert np.mean(np.any(pixels < 0.9, axis=2)) > 0.02


@pytest.mark.parametrize("name", NAMES[1:])
def test_a_figure_shows_simulation_and_theory(drawn: Any, name: str) -> None:
    svg = drawn(name)["svg"].decode()
    blues = {style.BLUE, *(colour for colour, _ in style.SERIES)}
    assert any(blue in svg for blue in blues)
    assert style.VERMILION in svg
    assert of_colour(_pixels(drawn(name)["png"]), style.VERMILION).sum() > 150


def test_the_geometry_tells_the_simulated_area_beside_the_formula(drawn: Any) -> None:
    words = _words(drawn("fig2")["svg"].decode())
    told = re.search(r"shaded: ([0-9.]+) µm² by Eq\. \(2\),.*?([0-9.]+) µm² in the simulation", words, re.DOTALL)
    assert told is not None, words
    assert told[1] == told[2]


def _words(svg: str) -> str:
    """Return the texts of a drawing, which stand in it as comments beside their outlines."""
    return "\n".join(re.findall(r"<!-- (.*?) -->", svg))


@pytest.mark.parametrize("name", ["fig3", "fig8", "fig6", "fig7"])
def test_a_figure_is_the_same_again_and_whatever_is_set(drawn: Any, name: str, tmp_path: Path) -> None:
    with mpl.rc_context({"font.size": 20.0, "axes.facecolor": "red", "svg.hashsalt": "x"}):
        again = paper_figure(name, style.FORMATS, Sources(folder=short_papers(tmp_path)))
    assert again == drawn(name)


@pytest.mark.parametrize("name", NAMES)
def test_files_tell_no_time_and_stay_small(drawn: Any, name: str) -> None:
    files = drawn(name)
    assert files["png"].startswith(b"\x89PNG")
    assert files["pdf"].startswith(b"%PDF")
    assert b"CreationDate" not in files["pdf"]
    assert b"dc:date" not in files["svg"]
    assert all(len(file) < 1_000_000 for file in files.values())


def test_a_wrong_name_is_told_with_the_right_ones() -> None:
    with pytest.raises(Refused, match=r"fig1, figure: no figure of the paper; there are fig2, .*, fig9"):
        chosen(["fig1", "fig2", "figure"])


# What the figures of the paper are drawn from: thinned curves, spreads with intervals, binned spectra.
def test_bins_of_a_spectrum_keep_its_integral() -> None:
    wavenumber = np.arange(5001) * 0.006
    density = 1.0 / (1.0 + wavenumber**4)
    seen = EstimatedSpectrum(wavenumber=wavenumber, density=density, standard_error=density, ticks=10_000, segments=50)
    places, means = merged_bins(seen)
    assert places[0] == wavenumber[FIRST]
    assert places.size < 500
    assert np.all(np.diff(places) > 0.0)
    assert np.diff(places).max() <= 1.5 * WIDEST
    assert np.abs(means * (1.0 + places**4) - 1.0).max() < 0.02
    widths = np.diff(np.searchsorted(wavenumber, [*places[:3], np.inf]))
    assert list(widths[:2]) == [1, 1]


@pytest.fixture(scope="module")
def spreads(tmp_path_factory: pytest.TempPathFactory) -> list[Spot]:
    folder = tmp_path_factory.mktemp("fig7")
    lines = ["format = 1", f'extends = "{PAPER / "fig7.toml"}"', "[run]", f"seed = {seed_of('spreads of figure 7')}"]
    lines += ["[sliding]", 'distance = "3 mm"', "[sweep]", "replicates = 2", "[sweep.grid]"]
    lines += ['interface.mean_real_contact_area = ["100 um^2", "300 um^2"]']
    lines += ["interface.mean_junction_count = [10, 20, 30]"]
    (folder / "fig7.toml").write_text("\n".join([*lines, ""]), encoding="utf-8")
    return [spot for line in spreads_of(Sources(folder=folder)) for spot in line]


def _z(spreads: list[Spot], factor: float) -> np.ndarray:
    return np.array([(seen - factor * area_cumulants(model).std) / error for model, seen, error in spreads])


def test_spreads_lie_about_the_exact_ones_by_their_errors(spreads: list[Spot]) -> None:
    assert [model.mean_junction_count for model, _, _ in spreads] == [10, 20, 30] * 2
    z = _z(spreads, 1.0)
    assert np.abs(z).max() <= 4.0
    assert 0.3 < np.square(z).sum() < 27.0  # chi-squared of 6: outside in fewer than 1 of 1000 on either side
    assert np.abs(_z(spreads, 1.15)).max() > 4.0  # what is 15 % off is noticed


def test_figure_7_takes_every_point_and_replicate() -> None:
    sweep = load_sweep(PAPER / "fig7.toml")
    assert (len(sweep.cases), sweep.replicates) == (25, 4)


# The command.
def test_figures_are_written_and_replaced_only_by_force(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (papers := tmp_path / "papers").mkdir()
    words = ["fig3", "fig2", "-o", str(tmp_path / "out"), "--scenarios", str(short_papers(papers)), "--format", "svg"]
    assert program.main(words) == 0
    files = [tmp_path / "out" / f"{name}.svg" for name in ("fig2", "fig3")]
    assert capsys.readouterr().out.split() == [str(file) for file in files]
    files[0].write_text("precious", encoding="utf-8")
    assert program.main(words) == 2
    assert "fig2.svg: exists already" in capsys.readouterr().err
    assert files[0].read_text(encoding="utf-8") == "precious"
    assert program.main([*words, "--force"]) == 0
    assert files[0].read_bytes().startswith(b"<?xml")
    assert program.main(["fig1"]) == 2
    assert "fig1: no figure of the paper" in capsys.readouterr().err


def test_the_pictures_of_the_gallery_are_there() -> None:
    assert all((PAPER.parents[1] / "docs" / "pictures" / "paper" / f"{name}.png").is_file() for name in FIGURES)
