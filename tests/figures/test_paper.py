"""The figures of the paper, what they are drawn from, and files of figures."""

import hashlib
import re
import subprocess
import sys
import warnings
from functools import cache
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib as mpl
import matplotlib.image
import numpy as np
import pytest

import rubnoise
from rubnoise.analysis.spectra import Spectrum
from rubnoise.errors import Refused
from rubnoise.figures import paper_spread, style
from rubnoise.figures.overview import overview_figure
from rubnoise.figures.paper import FIGURES, caption, check_sources, chosen, paper_figure
from rubnoise.figures.paper_sources import Sources
from rubnoise.figures.paper_spectra import FIRST, WIDEST, merged_bins
from rubnoise.figures.paper_spread import spreads_of
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.study import Spot
from rubnoise.figures.style import FORMATS, Format, as_bytes, as_png, house_style, logarithmic, new_figure
from rubnoise.figures.theory import theory_figure, theory_picture
from rubnoise.model import Model
from rubnoise.scenario.shipped import shipped
from rubnoise.scenario.sweep import load_sweep
from rubnoise.storage.reader import open_run
from tests.figures.papers import PAPER, of_colour, short_papers
from tests.verification.scores import seed_of

# The figures of the paper, and what they are drawn from.
# The figures of the paper: each shows simulation and theory, whole, and the same bytes whenever it is drawn.
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


@pytest.mark.parametrize("name", NAMES)
def test_its_axes_have_units(drawn: Any, name: str) -> None:
    words = _words(drawn(name)["svg"].decode())
    assert "µm" in words
    if name != "fig2":
        assert re.search(r"\((?:µm²?|mN|mm/s|s|1/µm²|rad/µm|rad|1/rad)\)|µm⁴ per rad/µm", words)


@pytest.mark.parametrize("name", ["fig3", "fig8", "fig6", "fig7"])
def test_a_figure_is_the_same_again_and_whatever_is_set(drawn: Any, name: str, tmp_path: Path) -> None:
    with mpl.rc_context({"font.size": 20.0, "axes.facecolor": "red", "svg.hashsalt": "x"}):
        again = paper_figure(name, style.FORMATS, Sources(folder=short_papers(tmp_path)))
    assert again == drawn(name)


@pytest.mark.parametrize("name", ["fig3", "fig5"])
@pytest.mark.parametrize("kind", style.FORMATS)
def test_a_format_does_not_depend_on_the_others(drawn: Any, name: str, kind: style.Format, tmp_path: Path) -> None:
    alone = paper_figure(name, (kind,), Sources(folder=short_papers(tmp_path)))
    assert alone == {kind: drawn(name)[kind]}


def test_another_seed_makes_another_figure(drawn: Any, tmp_path: Path) -> None:
    other = paper_figure("fig4", ("png",), Sources(folder=short_papers(tmp_path, seed=2)))
    assert other["png"] != drawn("fig4")["png"]


@pytest.mark.parametrize("name", NAMES)
def test_files_tell_no_time_and_stay_small(drawn: Any, name: str) -> None:
    files = drawn(name)
    assert files["png"].startswith(b"\x89PNG")
    assert files["pdf"].startswith(b"%PDF")
    assert b"CreationDate" not in files["pdf"]
    assert b"dc:date" not in files["svg"]
    assert all(len(file) < 1_000_000 for file in files.values())


def test_captions_are_sentences() -> None:
    for name, figure in FIGURES.items():
        assert caption(name) == figure.caption
        assert figure.caption.endswith(".")
        assert 1 <= figure.caption.count(". ") + 1 <= 4
        assert "\n" not in figure.caption


def test_the_scenarios_of_every_figure_come_along() -> None:
    check_sources(FIGURES)
    for figure in FIGURES.values():
        assert all(shipped(f"paper/{scenario}").is_file() for scenario in figure.scenarios)
    used = {scenario for figure in FIGURES.values() for scenario in figure.scenarios}
    # The one beside them is no figure of the paper, which couples one way.
    assert used | {"fig5_two_way.toml"} == {path.name for path in PAPER.glob("*.toml")}


def test_names_are_taken_in_the_papers_order() -> None:
    assert chosen(["fig8", "fig3", "fig8"]) == ("fig3", "fig8")
    assert chosen([]) == chosen(["all"]) == chosen(["fig2", "all"]) == tuple(NAMES)


def test_a_wrong_name_is_told_with_the_right_ones() -> None:
    with pytest.raises(Refused, match=r"fig1, figure: no figure of the paper; there are fig2, .*, fig9, and all"):
        chosen(["fig1", "fig2", "figure"])


# What the figures of the paper are drawn from: thinned curves, spreads with intervals, binned spectra.
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
def spreads(tmp_path_factory: pytest.TempPathFactory) -> list[Spot]:
    folder = tmp_path_factory.mktemp("fig7")
    lines = ["format = 1", f'extends = "{PAPER / "fig7.toml"}"', "[run]", f"seed = {seed_of('spreads of figure 7')}"]
    lines += ["[sliding]", 'distance = "3 mm"', "[sweep]", "replicates = 2", "[sweep.grid]"]
    lines += ['interface.mean_real_contact_area = ["100 um^2", "300 um^2"]']
    lines += ["interface.mean_junction_count = [10, 20, 30]"]
    (folder / "fig7.toml").write_text("\n".join([*lines, ""]), encoding="utf-8")
    return [spot for line in spreads_of(Sources(folder=folder), "fig7.toml").lines for spot in line.spots]


def _z(spreads: list[Spot], factor: float) -> np.ndarray:
    return np.array([(each.seen.value - factor * each.exact) / each.seen.standard_error for each in spreads])


def test_spreads_lie_about_the_exact_ones_by_their_errors(spreads: list[Spot]) -> None:
    assert [spread.place for spread in spreads] == [10, 20, 30] * 2
    z = _z(spreads, 1.0)
    assert np.abs(z).max() <= 4.0
    assert 0.3 < np.square(z).sum() < 27.0  # chi-squared of 6: outside in fewer than 1 of 1000 on either side
    assert np.abs(_z(spreads, 1.15)).max() > 4.0  # what is 15 % off is noticed


def test_four_replicates_halve_the_error_of_one(tmp_path: Path) -> None:
    errors = []
    for replicates in (1, 4):
        (tmp_path / "fig7.toml").write_text(
            f'format = 1\nextends = "{PAPER / "fig7.toml"}"\n[sliding]\ndistance = "300 um"\n[sweep]\n'
            f"replicates = {replicates}\n[sweep.grid]\ninterface.mean_junction_count = [10, 20]\n"
            'interface.mean_real_contact_area = ["100 um^2"]\n',
            encoding="utf-8",
        )
        (line,) = spreads_of(Sources(folder=tmp_path), "fig7.toml").lines
        errors.append(line.spots[0].seen.standard_error)
    assert errors[0] == pytest.approx(2.0 * errors[1], rel=1e-12)


def test_the_law_is_that_of_one_size() -> None:
    assert pytest.approx(1.2298, abs=5e-5) == paper_spread.LAW


def test_figure_7_takes_every_point_and_replicate() -> None:
    sweep = load_sweep(PAPER / "fig7.toml")
    assert (len(sweep.cases), sweep.replicates) == (25, 4)


def test_runs_are_counted_aloud(tmp_path: Path) -> None:
    (tmp_path / "fig7.toml").write_text(
        f'format = 1\nextends = "{PAPER / "fig7.toml"}"\n[sliding]\ndistance = "50 um"\n[sweep]\nreplicates = 1\n'
        "[sweep.grid]\ninterface.mean_junction_count = [10, 20]\n",
        encoding="utf-8",
    )
    told: list[tuple[int, int]] = []
    spreads_of(Sources(folder=tmp_path, watch=lambda done, runs: told.append((done, runs))), "fig7.toml")
    assert told == [(done, 10) for done in range(1, 11)]


# Files of figures, the picture of a theory, and the picture of the README.
# Files of figures: what they are, and that they say nothing about when and by what they were made.
BEGINNINGS = {"png": b"\x89PNG\r\n\x1a\n", "pdf": b"%PDF-", "svg": b"<?xml"}
ANEW = """
import hashlib, sys
from tests.figures.test_paper import FORMATS, drawn_as
print(*(hashlib.sha256(drawn_as(kind)).hexdigest() for kind in FORMATS))
"""


def drawn_as(kind: Format) -> bytes:
    with house_style():
        figure = new_figure(3.0, 2.0)
        axes = figure.subplots()
        axes.fill_between([0.0, 1.0], [1.0, 3.0], hatch="//", clip_on=True)
        axes.set_title("costs $5 of µm²")
        return as_bytes(figure, kind)


def test_a_figure_is_the_same_in_another_process() -> None:
    done = subprocess.run([sys.executable, "-c", ANEW], capture_output=True, text=True, check=True)
    assert done.stdout.split() == [hashlib.sha256(drawn_as(kind)).hexdigest() for kind in FORMATS]


@pytest.mark.parametrize("kind", FORMATS)
def test_a_file_is_of_its_kind_and_names_no_date(kind: Format) -> None:
    picture = drawn_as(kind)
    assert picture.startswith(BEGINNINGS[kind])
    assert b"CreationDate" not in picture
    assert b"dc:date" not in picture
    assert b"atplotlib v" not in picture


def test_powers_of_ten_are_letters_that_the_font_has() -> None:
    with house_style():
        figure = new_figure(3.0, 2.0)
        axes = figure.subplots()
        axes.plot([1e-3, 1e12], [1.0, 1e5])
        for axis in (axes.xaxis, axes.yaxis):
            logarithmic(axis)
        axes.set_xlim(1e-3, 1e12)
        labels = [text.get_text() for text in axes.get_xticklabels()]
        assert {"10⁻³", "10⁰", "10¹²"} <= set(labels)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            figure.savefig(BytesIO(), format="svg")


def test_an_axis_without_a_power_of_ten_has_numbers_all_the_same() -> None:
    with house_style():
        figure = new_figure(3.0, 2.0)
        axes = figure.subplots()
        axes.plot([2.0, 8.0], [2.0, 800.0])
        for axis in (axes.xaxis, axes.yaxis):
            logarithmic(axis)
        figure.draw_without_rendering()
        narrow, wide = ([text.get_text() for text in axis.get_minorticklabels()] for axis in (axes.xaxis, axes.yaxis))
    assert "4" in narrow
    assert set(wide) <= {""}


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


# The picture of the README.
ROOT = Path(__file__).parents[2]
PNG = b"\x89PNG\r\n\x1a\n"


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


def test_an_overview_is_the_same_each_time_and_that_of_its_junction(run):
    picture = overview(run, 60)
    assert picture.startswith(PNG)
    assert overview(run, 60) == picture
    assert overview(run, 61) != picture


def test_a_junction_that_is_not_there_is_refused(run):
    with pytest.raises(Refused, match="100000"):
        overview(run, 100_000)


def test_the_readme_shows_it():
    picture = "docs/pictures/gallery/overview.png"
    assert f"]({picture})" in (ROOT / "README.md").read_text(encoding="utf-8")
    assert (ROOT / picture).read_bytes().startswith(PNG)
