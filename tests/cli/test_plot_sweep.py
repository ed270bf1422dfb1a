"""`rubnoise plot DIR`: a quantity of a sweep against what is swept."""

from pathlib import Path

import numpy as np
import pytest

import rubnoise
from rubnoise.figures.study import quantities_of, study_of_sweep
from tests.cli.terminal import call, names
from tests.unit.sweeps import HEAD

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
    rubnoise.run_sweep(folder / "s.toml", folder / "study", jobs=1).close()
    return folder / "study"


def test_a_study_is_what_the_index_says(swept: Path) -> None:
    with rubnoise.open_sweep(swept) as sweep:
        study = study_of_sweep(sweep, STD)
        assert (study.title, study.key, study.unit) == ("study", "interface.mean_junction_count", "1")
        assert [line.label for line in study.lines] == ["100 µm²", "200 µm²"]
        figures, point = sweep.runs[STD][:], sweep.runs["point"][:]
        exact = sweep.runs[f"{STD}_exact"][:]
        for number, values in enumerate(sweep.values):
            line = study.lines[int(values["interface.mean_real_contact_area"] == "200 um^2")]
            [spot] = [spot for spot in line.spots if spot.place == values["interface.mean_junction_count"]]
            assert spot.seen.runs == 6
            assert spot.seen.value == pytest.approx(np.sqrt(np.square(figures[point == number]).mean()), rel=1e-12)
            assert spot.exact == pytest.approx(exact[point == number][0], rel=1e-12)
            assert abs(spot.seen.value - spot.exact) < 6.0 * spot.seen.standard_error
        assert quantities_of(sweep)[-1] == "junction_count_std"


def test_a_quantity_is_drawn(swept: Path, here: Path) -> None:
    answer = call("plot", swept, "junction_count_mean", "-o", "n.png")
    assert (answer.code, answer.out, answer.err) == (0, "n.png\n", "")
    assert (here / "n.png").read_bytes().startswith(b"\x89PNG")
    assert call("plot", swept).out == f"study_{STD}.png\n"
    assert names(here) == ["n.png", f"study_{STD}.png"]
    refused = call("plot", swept)
    assert (refused.code, refused.out) == (2, "")
    assert "exists already" in refused.err


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("displacement_std",), '"displacement_std": no quantity of this sweep; there are real_contact_area_mean, '),
        (("trace",), '"trace": no quantity of this sweep; there are '),
        ((STD, "--from", "5"), "--from, --to, --of and --with are for the pictures of one run"),
        ((STD, "--with", "x.h5"), "--from, --to, --of and --with are for the pictures of one run"),
        ((STD, "-o", "x.jpg"), "x.jpg ends in none of .png, .pdf and .svg"),
    ],
)
def test_what_cannot_be_drawn_is_refused(swept: Path, here: Path, arguments: tuple[str, ...], said: str) -> None:
    answer = call("plot", swept, *arguments)
    assert (answer.code, answer.out) == (2, "")
    assert said in " ".join(answer.err.replace("│", " ").split())
    assert names(here) == []


def test_a_folder_of_something_else_is_refused(here: Path) -> None:
    (here / "folder").mkdir()
    answer = call("plot", "folder")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err == "folder: no folder of a sweep: it has no index.h5\n"


def test_quantities_are_completed(here: Path) -> None:
    from rubnoise.cli.plot import complete

    assert complete("displ") == ["displacement_mean", "displacement_std"]
    assert complete("ac") == ["acf"]
