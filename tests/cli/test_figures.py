"""`rubnoise figures`: the paper's figures as files."""

import sys
from pathlib import Path

import pytest

from tests.cli.terminal import call, names, spawn
from tests.figures.papers import short_papers


@pytest.fixture
def papers(here: Path) -> Path:
    """Return a folder with short scenarios."""
    (folder := here.parent / "papers").mkdir()
    return short_papers(folder)


def test_a_figure_is_written_in_every_format(here: Path, papers: Path) -> None:
    answer = call("figures", "fig3", "-o", "out", "--scenarios", papers)
    assert (answer.code, answer.err) == (0, "")
    assert answer.out == "out/fig3.png\nout/fig3.pdf\nout/fig3.svg\n"
    assert names(here / "out") == ["fig3.pdf", "fig3.png", "fig3.svg"]


def test_the_bytes_are_the_same_in_another_process(here: Path, papers: Path) -> None:
    assert call("figures", "fig2", "fig3", "-o", "one", "--scenarios", papers).code == 0
    assert spawn("figures", "fig3", "fig2", "-o", "two", "--scenarios", papers, PYTHONHASHSEED="7").code == 0
    assert names(here / "one") == names(here / "two")
    for name in names(here / "one"):
        assert (here / "one" / name).read_bytes() == (here / "two" / name).read_bytes()


def test_it_goes_into_a_folder_of_its_own_by_default(here: Path, papers: Path) -> None:
    answer = call("figures", "fig2", "--format", "svg", "--scenarios", papers)
    assert (answer.code, answer.out) == (0, "figures/fig2.svg\n")
    assert names(here) == ["figures"]


def test_the_shipped_scenarios_are_those_of_the_paper(here: Path) -> None:
    assert call("figures", "fig4", "--format", "png", "-o", ".").code == 0
    assert names(here) == ["fig4.png"]


def test_quiet_is_silent(here: Path, papers: Path) -> None:
    answer = spawn("figures", "fig3", "-q", "--format", "pdf", "-o", "a/b", "--scenarios", papers)
    assert (answer.code, answer.out, answer.err) == (0, "", "")
    assert names(here / "a" / "b") == ["fig3.pdf"]


def test_an_existing_picture_is_replaced_only_by_force(here: Path, papers: Path) -> None:
    (here / "out").mkdir()
    (here / "out" / "fig3.pdf").write_text("precious", encoding="utf-8")
    arguments = ("figures", "fig2", "fig3", "-o", "out", "--scenarios", papers)
    answer = call(*arguments)
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.endswith("out/fig3.pdf: exists already (--force replaces it)\n")
    assert names(here / "out") == ["fig3.pdf"]
    assert call(*arguments, "--force").code == 0
    assert (here / "out" / "fig3.pdf").read_bytes().startswith(b"%PDF")
    assert len(names(here / "out")) == 6


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("fig1",), "fig1: no figure of the paper; there are fig2, fig3, fig4, fig5, fig6, fig7, fig8, fig9, and all"),
        (("fig3", "--format", "jpg"), "there are png, pdf, svg"),
        (("fig3", "-o", "file"), "file: is no folder"),
        (("fig3", "-o", "file/below"), "file: is no folder"),
        (("fig3", "--scenarios", "."), "fig3.toml: cannot be read: no such file or directory"),
    ],
)
def test_what_cannot_be_is_refused_before_anything_is_made(here: Path, arguments: tuple[str, ...], said: str) -> None:
    (here / "file").touch()
    answer = call("figures", *arguments)
    assert (answer.code, answer.out) == (2, "")
    assert said in " ".join(answer.err.replace("│", " ").split())
    assert names(here) == ["file"]


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="needs a folder in which none can be made")
def test_a_folder_that_cannot_be_made_is_refused(here: Path) -> None:
    answer = call("figures", "fig3", "-o", "/proc/none")
    assert (answer.code, answer.out) == (2, "")
    # A user who is not root reads about the folder above.
    assert answer.err.startswith("/proc")
    assert "writable" in answer.err or "cannot be written" in answer.err


def test_wrong_scenarios_are_refused_with_their_lines(here: Path, papers: Path) -> None:
    (papers / "fig7.toml").write_text((papers / "fig7.toml").read_text().replace("[10, 30", "[-1, 30"))
    answer = call("figures", "--scenarios", papers)
    assert (answer.code, answer.out) == (2, "")
    assert "fig7.toml:10: error: interface.mean_junction_count: must be above 0" in answer.err
    assert names(here) == []


def test_without_matplotlib_it_is_said_how_to_get_it(here: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    answer = call("figures", "fig3")
    assert (answer.code, answer.out) == (2, "")
    assert answer.err.startswith("a picture needs matplotlib: python3 ")
    assert names(here) == []
