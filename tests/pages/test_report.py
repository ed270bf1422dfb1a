import re
import tomllib
from html import unescape
from pathlib import Path

import pytest

import rubnoise
from rubnoise.scenario.writing import text_of
from tests.cli.terminal import call


@pytest.fixture(scope="module")
def text(one_way: Path, tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("report") / "report.html"
    assert call("report", one_way, "-o", path).code == 0
    return path.read_text(encoding="utf-8")


def test_a_report_has_figures_pictures_sound_and_film(text: str, one_way: Path) -> None:
    assert text.count("data:image/png;base64,") == 9  # landmarks are of two-way runs
    assert text.count("data:image/gif;base64,") == 1
    assert text.count("<audio controls") == 1
    with rubnoise.open(one_way) as run:
        for figure in run.summary:
            assert f"<td>{figure.observed:.6g}</td>" in text
    assert all(re.findall(r'<img alt="([^"]*)"', text))
    assert not re.search(r"""(?:src|href)=["'](?!data:)""", text)


def test_the_scenario_in_a_report_makes_the_same_run_again(text: str, one_way: Path, tmp_path: Path) -> None:
    scenario = tmp_path / "scenario.toml"
    found = re.search(r"<pre>(.*?)</pre>", text, re.DOTALL)
    assert found is not None
    scenario.write_text(unescape(found[1]), encoding="utf-8")
    assert call("run", scenario, "-o", tmp_path / "again.h5").code == 0
    with rubnoise.open(one_way) as run, rubnoise.open(tmp_path / "again.h5") as again:
        assert again.slider["displacement"][:].tobytes() == run.slider["displacement"][:].tobytes()


TITLE = '🧲 of 3 µm, a \\ "quote" and \x7f'


def test_a_scenario_in_a_report_is_toml_whatever_its_title_says(one_way: Path, tmp_path: Path) -> None:
    with rubnoise.open(one_way) as run:
        resolved = run.scenario.resolved() | {"title": TITLE}
    assert tomllib.loads(text_of(resolved)) == resolved


def test_a_bare_run_has_a_report_without_what_it_lacks(tmp_path: Path) -> None:
    scenario = tmp_path / "bare.toml"
    scenario.write_text(
        "format = 1\ntitle = '<i>bare</i>'\n[interface]\nmean_real_contact_area = '200 um^2'\n"
        "mean_junction_count = 20\n[sliding]\ndistance = '500 um'\n",
        encoding="utf-8",
    )
    assert call("run", scenario, "-o", tmp_path / "bare.h5").code == 0
    answer = call("report", tmp_path / "bare.h5", "-o", tmp_path / "bare.html")
    assert answer.code == 0, answer.err
    text = (tmp_path / "bare.html").read_text(encoding="utf-8")
    assert "<audio" not in text
    assert "<i>" not in text
    assert "slider" not in unescape(text).split("How to repeat")[0].split("Pictures")[0]


def test_a_sweep_has_a_report(sweep_folder: Path, tmp_path: Path) -> None:
    answer = call("report", sweep_folder, "-o", tmp_path / "sweep.html")
    assert answer.code == 0, answer.err
    text = (tmp_path / "sweep.html").read_text(encoding="utf-8")
    assert "3 points over" in text
    assert "6 done" in text
    assert text.count("data:image/png;base64,") >= 8
    with rubnoise.open_sweep(sweep_folder) as sweep:
        pooled = sweep.estimates("displacement_std")[2]
    assert f"{pooled.value:.5g} ± {pooled.reach:.2g}" in text


@pytest.mark.parametrize("command", ["view", "report"])
def test_bad_input_is_refused_and_nothing_is_written(command: str, one_way: Path, tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    assert call(command, tmp_path / "none.h5", "-o", page).code == 2
    assert call(command, one_way, "-o", tmp_path / "page.txt").code == 2
    assert list(tmp_path.iterdir()) == []
    page.write_text("mine", encoding="utf-8")
    refused = call(command, one_way, "-o", page)
    assert refused.code == 2
    assert "--force" in refused.err
    assert page.read_text(encoding="utf-8") == "mine"


def test_a_stretch_outside_of_the_run_is_refused(one_way: Path, tmp_path: Path) -> None:
    refused = call("view", one_way, "--from", "1 m", "-o", tmp_path / "page.html")
    assert refused.code == 2
    assert "the run goes from 0 to 400 um" in refused.err
    assert list(tmp_path.iterdir()) == []
