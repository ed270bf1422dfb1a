"""`rubnoise plot`: pictures of runs and of sweeps in files."""

from pathlib import Path

import numpy as np
import pytest

import rubnoise
from rubnoise.figures.study import quantities_of, study_of_sweep
from tests.shell.terminal import call, names
from tests.unit.scenarios import HEAD

# `rubnoise plot`: pictures of a run in files.
CONTACT = Path("../given/contact.toml")
SLIDER = Path("../given/slider.toml")
BEGINNINGS = {"png": b"\x89PNG\r\n\x1a\n", "pdf": b"%PDF-", "svg": b"<?xml"}


@pytest.fixture
def result(here: Path) -> Path:
    assert call("run", SLIDER, "-q", "-o", "x.h5").code == 0
    return here / "x.h5"


def test_the_trace_is_drawn_where_nothing_is_said(result: Path, here: Path) -> None:
    answer = call("plot", "x.h5")
    assert (answer.code, answer.out, answer.err) == (0, "x_trace.png\n", "")
    assert (here / "x_trace.png").read_bytes().startswith(BEGINNINGS["png"])
    assert names(here) == ["x.h5", "x_trace.png"]


@pytest.mark.slow
@pytest.mark.parametrize("what", ["lives", "histogram", "psd", "acf", "count", "slider", "phase"])
def test_every_picture_has_a_name_of_its_own(result: Path, here: Path, what: str) -> None:
    assert call("plot", "x.h5", what).out == f"x_{what}.png\n"
    assert names(here) == ["x.h5", f"x_{what}.png"]


@pytest.mark.slow("pdf")
@pytest.mark.parametrize("kind", BEGINNINGS)
def test_the_ending_chooses_the_format(result: Path, here: Path, kind: str) -> None:
    (here / "sub").mkdir()
    assert call("plot", "x.h5", "acf", "-o", f"sub/a.{kind.upper()}").code == 0
    assert (here / "sub" / f"a.{kind.upper()}").read_bytes().startswith(BEGINNINGS[kind])
    assert names(here / "sub") == [f"a.{kind.upper()}"]


@pytest.mark.slow
def test_a_run_without_a_slider_has_the_pictures_of_its_contact(here: Path) -> None:
    assert call("run", CONTACT, "-q", "-o", "bare.h5").code == 0
    for what in ("trace", "lives", "histogram", "psd", "acf", "count"):
        assert call("plot", "bare.h5", what).code == 0


def test_an_area_that_is_never_above_0_is_drawn_without_a_warning(here: Path) -> None:
    short = ("--set", "sliding.distance=0.05 um", "--set", "output.tick=0.05 um")
    assert call("run", "load/bouncing", "-q", "-o", "b.h5", "--seed", "2", *short).code == 0
    with rubnoise.open("b.h5") as run:
        assert run.trace["real_contact_area"][:].max() == 0.0
    answer = call("plot", "b.h5", "histogram")
    assert (answer.code, answer.err) == (0, "")


# `rubnoise plot DIR`: a quantity of a sweep against what is swept.
SWEPT = """\
[diameter]
law = "normal"
spread = "0.2 um"
[output]
tick = "0.2 um"
[sweep]
keep = "summary"
replicates = 6
[sweep.grid]
interface.mean_junction_count = [10, 20, 40]
interface.mean_real_contact_area = ["100 um^2", "200 um^2"]
"""
STD = "real_contact_area_std"


@pytest.fixture(scope="module")
def swept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of a sweep of six points, six runs of each."""
    folder = tmp_path_factory.mktemp("swept")
    (folder / "s.toml").write_text(HEAD + SWEPT, encoding="utf-8")
    rubnoise.sweep(folder / "s.toml", folder / "study", jobs=1).close()
    return folder / "study"


@pytest.mark.slow
def test_a_study_is_what_the_index_says(swept: Path) -> None:
    with rubnoise.open_sweep(swept) as sweep:
        study = study_of_sweep(sweep.index, sweep.name, STD)
        assert (study.title, study.key, study.unit) == ("study", "interface.mean_junction_count", "1")
        assert [*study.lines] == ["100 µm²", "200 µm²"]
        figures, point = sweep.runs[STD][:], sweep.runs["point"][:]
        exact = sweep.runs[f"{STD}_exact"][:]
        for number, values in enumerate(sweep.values):
            rows = study.lines[values["interface.mean_real_contact_area"].replace("um^2", "µm²")]
            [row] = [row for row in rows if study.place[row] == values["interface.mean_junction_count"]]
            seen = study.seen[row]
            assert seen.runs == 6
            assert seen.value == pytest.approx(np.sqrt(np.square(figures[point == number]).mean()), rel=1e-12)
            assert study.exact[row] == pytest.approx(exact[point == number][0], rel=1e-12)
            assert abs(seen.value - study.exact[row]) < 6.0 * seen.standard_error
        assert quantities_of(sweep.index)[-1] == "junction_count_std"


@pytest.mark.slow
def test_a_quantity_is_drawn(swept: Path, here: Path) -> None:
    answer = call("plot", swept, "junction_count_mean", "-o", "n.png")
    assert (answer.code, answer.out, answer.err) == (0, "n.png\n", "")
    assert (here / "n.png").read_bytes().startswith(b"\x89PNG")
    assert call("plot", swept).out == f"study_{STD}.png\n"
    assert names(here) == ["n.png", f"study_{STD}.png"]
    refused = call("plot", swept)
    assert (refused.code, refused.out) == (2, "")
    assert "exists already" in refused.err
