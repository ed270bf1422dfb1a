"""`rubnoise plot`: pictures of a run in files."""

import sys
from pathlib import Path

import pytest

from rubnoise.cli.plot import What
from rubnoise.figures.catalogue import PICTURES
from tests.cli.terminal import call, names
from tests.format.runs import describe, random_rows, write_run

CONTACT = Path("../given/contact.toml")
SLIDER = Path("../given/slider.toml")
BEGINNINGS = {"png": b"\x89PNG\r\n\x1a\n", "pdf": b"%PDF-", "svg": b"<?xml"}


@pytest.fixture
def result(here: Path) -> Path:
    assert call("run", SLIDER, "-q", "-o", "x.h5").code == 0
    return here / "x.h5"


@pytest.fixture
def bare(here: Path) -> Path:
    assert call("run", CONTACT, "-q", "-o", "bare.h5").code == 0
    return here / "bare.h5"


def test_every_picture_can_be_asked_for() -> None:
    assert list(What) == list(PICTURES)


def test_the_trace_is_drawn_where_nothing_is_said(result: Path, here: Path) -> None:
    answer = call("plot", "x.h5")
    assert (answer.code, answer.out, answer.err) == (0, "x_trace.png\n", "")
    assert (here / "x_trace.png").read_bytes().startswith(BEGINNINGS["png"])
    assert names(here) == ["x.h5", "x_trace.png"]


@pytest.mark.parametrize("what", ["lives", "histogram", "psd", "acf", "count", "slider", "phase"])
def test_every_picture_has_a_name_of_its_own(result: Path, here: Path, what: str) -> None:
    assert call("plot", "x.h5", what).out == f"x_{what}.png\n"
    assert names(here) == ["x.h5", f"x_{what}.png"]


@pytest.mark.parametrize("of", ["force", "displacement", "velocity"])
def test_a_spectrum_is_called_after_what_it_is_of(result: Path, here: Path, of: str) -> None:
    assert call("plot", "x.h5", "psd", "--of", of).out == f"x_psd_{of}.png\n"
    assert call("plot", "x.h5", "psd", "--of", "area").out == "x_psd.png\n"
    assert (here / "x_psd.png").read_bytes() != (here / f"x_psd_{of}.png").read_bytes()


def test_a_run_without_a_slider_is_not_laid_over_one(result: Path, bare: Path, here: Path) -> None:
    for words, named in (
        (("x.h5", "slider", "--with", "bare.h5"), "--with bare.h5"),
        (("bare.h5", "slider", "--with", "x.h5"), "bare.h5"),
    ):
        answer = call("plot", *words)
        said = f"{named}: the run has no slider to draw; [slider] in its scenario would give it one\n"
        assert (answer.code, answer.out, answer.err) == (2, "", said)
    assert names(here) == ["bare.h5", "x.h5"]


@pytest.mark.parametrize("kind", BEGINNINGS)
def test_the_ending_chooses_the_format(result: Path, here: Path, kind: str) -> None:
    (here / "sub").mkdir()
    assert call("plot", "x.h5", "acf", "-o", f"sub/a.{kind.upper()}").code == 0
    assert (here / "sub" / f"a.{kind.upper()}").read_bytes().startswith(BEGINNINGS[kind])
    assert names(here / "sub") == [f"a.{kind.upper()}"]


def test_a_stretch_is_chosen_in_um_or_with_units(result: Path, here: Path) -> None:
    for name, stretch in (
        ("a.png", ("--from", "50", "--to", "90")),
        ("b.png", ("--from", "0.05 mm", "--to", "90 um")),
        ("c.png", ("--from", "50", "--to", "91")),
    ):
        assert call("plot", "x.h5", "-o", name, *stretch).code == 0
    first, same, other = ((here / name).read_bytes() for name in ("a.png", "b.png", "c.png"))
    assert first == same
    assert first != other


def test_a_file_is_replaced_only_by_force(result: Path, here: Path) -> None:
    (here / "x_trace.png").write_bytes(b"precious")
    answer = call("plot", "x.h5")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.endswith("x_trace.png: exists already (--force replaces it)\n")
    assert (here / "x_trace.png").read_bytes() == b"precious"
    assert call("plot", "x.h5", "--force").code == 0
    assert (here / "x_trace.png").read_bytes().startswith(BEGINNINGS["png"])


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("fft",), "'fft' is not one of 'trace', 'lives', 'histogram', 'psd', 'acf', 'count', 'slider', 'phase',"),
        (("landmarks",), 'only with slider.coupling = "two-way" does it stick and slip'),
        (("psd", "--of", "fft"), "'fft' is not one of"),
        (("slider", "--of", "velocity"), "--of is for psd, not for slider"),
        (("trace", "--with", "x.h5"), "--with is for slider, phase, and psd --of force, displacement or velocity"),
        (("psd", "--with", "x.h5"), "--with is for slider, phase, and psd --of force, displacement or velocity"),
        (("slider", "--with", "y.h5"), "y.h5: no such file or directory"),
        (("-o", "x.jpg"), "x.jpg ends in none of .png, .pdf and .svg"),
        (("-o", "none/x.png"), "no such folder"),
        (("--from", "x"), "--from: x: not a number and a unit"),
        (("--to", "5 kg"), '--to: 5 kg: "kg" is the unit of a mass, a length is needed'),
        (("--from", "nan"), "--from: nan: not a finite number"),
        (("--from", "400"), "x.h5: nothing lies in 400 to 300 um; the run goes from 0 to 300 um"),
        (("--from", "5", "--to", "5.05"), "x.h5: 5 to 5.05 um is too short to draw"),
        (("psd", "--to", "10"), "x.h5: a spectrum needs a stretch of 24.8 um or more"),
    ],
)
def test_what_cannot_be_drawn_is_refused(result: Path, here: Path, arguments: tuple[str, ...], said: str) -> None:
    answer = call("plot", "x.h5", *arguments)
    assert (answer.code, answer.out) == (2, "")
    assert said in " ".join(answer.err.replace("│", " ").split())
    assert names(here) == ["x.h5"]


def test_a_run_without_a_slider_says_so(bare: Path, here: Path) -> None:
    said = "the run has no slider to draw; [slider] in its scenario would give it one\n"
    for what in ("slider", "phase"):
        answer = call("plot", "bare.h5", what)
        assert (answer.code, answer.out, answer.err) == (2, "", f"bare.h5: {said}")
    for what in ("trace", "lives", "histogram", "psd", "acf", "count"):
        assert call("plot", "bare.h5", what).code == 0


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("folder", "folder: no folder of a sweep: it has no index.h5\n"),
        ("missing.h5", "missing.h5: no such file or directory\n"),
        ("NO_DIR", "NO_DIR: no such file or directory\n"),
        (
            "../given/contact.toml",
            (
                "../given/contact.toml: is a scenario, not a result; `rubnoise check ../given/contact.toml` says what"
                " follows from it, `rubnoise run` runs it\n"
            ),
        ),
    ],
)
def test_what_is_no_result_is_refused(here: Path, path: str, said: str) -> None:
    (here / "folder").mkdir()
    for what in ((), ("trace",), ("x",)) if path in ("missing.h5", "NO_DIR") else ((), ("trace",)):
        answer = call("plot", path, *what)
        assert (answer.code, answer.out, answer.err) == (2, "", said)
    assert names(here) == ["folder"]


def test_an_unfinished_result_is_refused(here: Path) -> None:
    said = []

    def look() -> None:
        said.append(call("plot", "x.h5.part", "-o", "p.png"))

    description = describe()
    write_run("x.h5", description, random_rows(description), meanwhile=look)
    assert said[0].code == 2
    assert said[0].err == "x.h5.part: unfinished; rubnoise resume x.h5.part continues it\n"


def test_a_result_whose_scenario_is_none_is_refused(here: Path) -> None:
    description = describe()
    write_run("odd.h5", description, random_rows(description))
    answer = call("plot", "odd.h5")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err == "odd.h5: the scenario in the file is not valid\n"
    assert names(here) == ["odd.h5"]


def test_without_matplotlib_nothing_is_written(result: Path, here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    answer = call("plot", "x.h5")
    assert (answer.code, answer.out) == (2, "")
    assert "tools/dev.py sync" in answer.err.replace("'", "")
    assert names(here) == ["x.h5"]
