"""The report and the view of a run as data, without a browser."""

import json
import re
from html import unescape
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rubnoise
from rubnoise.analysis.spectra import WelchSum
from rubnoise.analysis.where import Condition, ConditionRefused
from rubnoise.answer import shown
from rubnoise.errors import Refused
from rubnoise.figures.tracks import Stretch
from rubnoise.pages import run_view
from rubnoise.storage.reader import open_run
from tests.pages.reading import PARTS, answer, data_of
from tests.shell.terminal import PAPER, call


@pytest.fixture(scope="module")
def text(one_way: Path, tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("report") / "report.html"
    assert call("report", one_way, "-o", path).code == 0
    return path.read_text(encoding="utf-8")


@pytest.mark.slow
def test_a_report_has_figures_pictures_and_sound(text: str, one_way: Path) -> None:
    assert text.count("data:image/png;base64,") == 9  # landmarks are of two-way runs
    assert text.count("<audio controls") == 1
    with rubnoise.open(one_way) as run:
        for figure in run.summary:
            assert f" {shown(figure.value)} " in text
    assert all(re.findall(r'<img alt="([^"]*)"', text))
    assert not re.search(r"""(?:src|href)=["'](?!data:)""", text)


@pytest.mark.slow
def test_a_report_of_free_motion_says_how_long_it_was_off_and_shows_no_theory(bouncing: Path, tmp_path: Path) -> None:
    assert call("report", bouncing, "-o", tmp_path / "report.html").code == 0
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    with rubnoise.open(bouncing) as run:
        off = 100.0 * float(np.mean(run.trace["junction_count"][:] == 0))
        fallen = int(np.sum(run.groups()["landmarks"]["kind"] == 5))
        end = float(run.groups()["load"]["time"][-1])
    said = re.search(r"off the surface for ([0-9.]+) % of the time, and fell on it ([0-9.]+) times a second", text)
    assert said is not None
    assert abs(float(said[1]) - off) < 0.2
    assert float(said[2]) == pytest.approx(fallen / end, rel=6e-3)
    assert text.count("data:image/png;base64,") == 9
    assert "the exact density" not in text
    assert "A slider of 5 g slides over 6 mm of a rough surface" in text
    assert "The normal velocity of the slider" in text


@pytest.mark.slow
def test_the_scenario_in_a_report_makes_the_same_run_again(text: str, one_way: Path, tmp_path: Path) -> None:
    scenario = tmp_path / "scenario.toml"
    found = re.search(r"Scenario</h2><pre>(.*?)</pre>", text, re.DOTALL)
    assert found is not None
    scenario.write_text(unescape(found[1]), encoding="utf-8")
    assert call("run", scenario, "-o", tmp_path / "again.h5").code == 0
    with rubnoise.open(one_way) as run, rubnoise.open(tmp_path / "again.h5") as again:
        assert again.slider["displacement"][:].tobytes() == run.slider["displacement"][:].tobytes()


@pytest.mark.slow
def test_the_page_of_a_sweep_has_the_spectrum_of_each_point(sweep_folder: Path, tmp_path: Path) -> None:
    assert call("view", sweep_folder, "-o", tmp_path / "sweep.html").code == 0
    data = data_of((tmp_path / "sweep.html").read_text(encoding="utf-8"))
    assert sorted(data["points"][data["runs"].index(run)] for run in data["spectra"]) == [0, 1, 2]
    with rubnoise.open_sweep(sweep_folder) as sweep:
        for name, (wavenumber, density) in data["spectra"].items():
            with sweep.run(name) as run:
                life, area = run.model().mean_life_distance, run.trace["real_contact_area"][:]
            total = WelchSum(2 * int(0.5 * min(8.0 * life / 0.1, len(area) / 4)), 0.1)
            total.add(area)
            seen = total.spectrum()
            assert density == pytest.approx(np.interp(wavenumber, seen.wavenumber, seen.density), rel=1e-9)


@pytest.mark.slow
def test_the_page_of_a_sweep_holds_the_runs_that_are_done(tmp_path: Path) -> None:
    (tmp_path / "s.toml").write_text(
        f'format = 1\nextends = "{(PAPER / "fig5.toml").as_posix()}"\n[sliding]\ndistance = "50 um"\n'
        "[sweep]\nreplicates = 2\n[sweep.grid]\ninterface.mean_junction_count = [5, 10, 20]\n",
        encoding="utf-8",
    )
    half = tmp_path / "half"
    assert call("sweep", tmp_path / "s.toml", "-o", half, "--shard", "1/2", "--jobs", "1", "-q").code == 0
    assert call("view", half, "-o", tmp_path / "half.html").code == 0
    data = data_of((tmp_path / "half.html").read_text(encoding="utf-8"))
    with rubnoise.open_sweep(half) as sweep:
        done = sweep.runs["run_id"][:][sweep.runs["state"][:] == "done"].tolist()
    assert (len(done), data["runs"], data["states"]) == (3, done, {"done": 3, "failed": 0, "planned": 3})
    assert {len(column["values"]) for column in data["columns"].values()} == {3}


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


CONDITIONS = (
    "diameter > 5.5 um",
    "diameter > 0.0055 mm",
    "diameter >= 5500nm and not alive_at_start",
    "0 < birth_distance < 0.1 mm or alive_at_end",
    "not (ended_early or birth_distance < 100 um)",
    "complete",
    "state == alive_at_start",
    "state != complete and junction > 3",
    "max_area<24.5um^2",
    "birth_time <= 100 ms",
    "death_distance > birth_distance",
    "shear_strength == 0.25 GPa",
    "not not complete",
    "(((junction == 17)))",
    "10 > diameter > 5.4 and life_distance < 1.2e-2 mm",
)
REFUSED = (
    "",
    "diameter",
    "diameter >",
    "6 um",
    "diameter > 6 s",
    "diameter > 6 parsec",
    "diametr > 6 um",
    "diameter = 6 um",
    "diameter > 6 um or",
    "diameter > 6 um)",
    "(diameter > 6 um",
    "1 < 2",
    "diameter > birth_time",
    "state > complete",
    "complete == 1",
    "junction > 3 um",
    "diameter > 1,5 um",
    "diameter AND complete",
    "diameter > 6 um complete",
    "diameter > .5",
    "diameter > 1e999 um",
    "diameter * 2 > 6",
    "diameter > 6 um && complete",
    "(" * 300 + "complete" + ")" * 300,
)


def page_of(path: Path, *ends: float) -> str:
    with open_run(path) as file:
        return run_view.run_page(run_view.held_by_a_page(Stretch.of(file, *ends)))


@pytest.fixture(scope="module")
def data(one_way: Path) -> dict[str, Any]:
    return data_of(page_of(one_way))


def test_conditions_choose_the_rows_that_the_command_chooses(data: dict[str, Any], one_way: Path) -> None:
    body = """return conditions.map((text) => {
      const chosen = view.where(text, view.lives, view.data.states);
      return Array.from(view.lives.junction).filter((_, i) => chosen(i));
    });"""
    found = answer(data, body, conditions=CONDITIONS)
    with rubnoise.open(one_way) as run:
        columns = {name: run.junctions[name][:] for name in run.junctions}
    expected = [np.flatnonzero(Condition(text).chosen(columns)).tolist() for text in CONDITIONS]
    assert found == expected
    assert all(len(rows) > 0 for rows in expected)
    assert sum(len(rows) < len(columns["junction"]) for rows in expected) > 8  # most of them leave some out


def test_what_is_no_condition_is_refused_by_both(data: dict[str, Any]) -> None:
    body = """return conditions.map((text) => {
      try { view.where(text, view.lives, view.data.states); return null; }
      catch (refused) { return refused instanceof view.ConditionRefused ? refused.message : `failed: ${refused}`; }
    });"""
    for text, message in zip(REFUSED, answer(data, body, conditions=REFUSED), strict=True):
        with pytest.raises(ConditionRefused):
            Condition(text)
        assert message, text
        assert not message.startswith("failed"), text


@pytest.mark.slow
@pytest.mark.parametrize("ends", [(), (100.0, 140.0)])
def test_lives_have_the_numbers_of_the_command(one_way: Path, ends: tuple[float, ...]) -> None:
    compare_lives(one_way, [0, 17, 18, 300] if not ends else [200, 230], *ends)


@pytest.mark.slow
def test_lives_off_the_centre_line_have_them_too(off_centre: Path) -> None:
    lives = compare_lives(off_centre, [0, 17, 18, 300])
    assert all(0.0 < abs(life["offset"]) < life["diameter"] for life in lives)


BIRTH = 2.0 * 256 * 0.5530013 * 2.0**-24
"""um: a birth is a float32 number behind the first of 256 births, twice as far apart as usual here at most."""
ROUNDING = 20.0 * 6.0 * BIRTH / 20.0 + 2.0**-23
"""Of a sum of areas over itself: some 20 junctions rise by up to their diameter a um; one has 20 um^2 at its peak."""


def compare_lives(path: Path, junctions: list[int], *ends: float) -> list[dict[str, Any]]:
    """Compare the lives of a page with those of the command, and return them."""
    data = data_of(page_of(path, *ends))
    body = "return junctions.map((number) => view.life(view.lives.junction.indexOf(number)));"
    lives: list[dict[str, Any]] = answer(data, body, junctions=junctions)
    for number, life in zip(junctions, lives, strict=True):
        values = call("junction", path, str(number), "--json").values()
        told, peak = values["junction"], values["peak"]
        pairs = [
            (life["birth"], told["birth_distance"]),
            (life["middle"], told.get("mid_life_distance")),
            (life["death"], told["death_distance"]),
            (life["birthTime"], told.get("birth_time")),
            (life["diameter"], told["diameter"]),
            (life["offset"], told.get("lateral_offset")),
            (life["maxArea"], told["max_area"]),
            (life["strength"], told.get("shear_strength")),
            (life["peak"], peak["distance"]),
            (life["peakArea"], peak["area"]),
            (life["peakForce"], peak.get("force")),
            (life["realContactArea"], peak["real_contact_area"]),
            (life["frictionForce"], peak.get("friction_force")),
            (life["areaShare"], peak["area_share"]),
        ]
        for ours, theirs in pairs:
            assert ours == (theirs if theirs is None else pytest.approx(theirs, rel=ROUNDING, abs=BIRTH))
        assert life["others"] == peak["others_alive"]
    return lives


@pytest.mark.slow
def test_a_page_of_a_stretch_holds_its_rows_and_the_extremes_of_all(one_way: Path) -> None:
    data = data_of(page_of(one_way, 100.0, 140.0))
    body = """const trace = view.columns(view.data.groups.trace.columns);
      const level = view.data.levels.trace.real_contact_area;
      return { first: view.data.groups.trace.first, area: Array.from(trace.real_contact_area),
               low: Array.from(view.unpacked(level.low)), high: Array.from(view.unpacked(level.high)) };"""
    found = answer(data, body)
    with rubnoise.open(one_way) as run:
        area = run.trace["real_contact_area"][:]
    assert found["first"] == 1000
    assert found["area"] == area[1000:1401].tolist()
    assert len(found["low"]) == len(area)  # a run so short has a cell for every tick
    assert (min(found["low"]), max(found["high"])) == (area.min(), area.max())


@pytest.mark.slow
def test_cells_of_a_longer_run_hold_its_extremes(one_way: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(run_view, "CELLS", 100)
    data = data_of(page_of(one_way))
    level = data["levels"]["trace"]
    found = answer(
        data,
        "return ['low', 'high'].map((end) => Array.from(view.unpacked(cells[end])));",
        cells=level["real_contact_area"],
    )
    with rubnoise.open(one_way) as run:
        area = run.trace["real_contact_area"][:]
    starts = np.arange(0, area.size, level["step"])
    assert len(found[0]) == starts.size <= 100
    assert found[0] == np.minimum.reduceat(area, starts).tolist()
    assert found[1] == np.maximum.reduceat(area, starts).tolist()


@pytest.mark.slow
def test_a_long_run_is_held_in_part_and_too_long_a_stretch_is_refused(
    one_way: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(run_view, "USUAL_BYTES", 30_000)
    data = data_of(page_of(one_way))
    assert data["start"] == 0.0
    assert 20.0 < data["stop"] < 200.0
    assert data["junctionRows"] > 700
    monkeypatch.setattr(run_view, "MOST_BYTES", 90_000)
    with pytest.raises(Refused, match=r"0 to 400 um hold .* MB of ticks, .* choose a shorter stretch, of about"):
        page_of(one_way, 0.0, 400.0)
    assert data_of(page_of(one_way))["stop"] == data["stop"]


def test_a_page_asks_for_nothing_and_a_title_stays_text(tmp_path: Path) -> None:
    title = '</title></script><script>alert(1)</script><b>"x'
    scenario = rubnoise.load(_bare(tmp_path, title))
    rubnoise.run(scenario, tmp_path / "run.h5").close()
    text = page_of(tmp_path / "run.h5")
    assert "<b>" not in re.sub(r"<script>.*?</script>", "", text, flags=re.DOTALL)
    assert text.count("<script>") == 1
    assert data_of(text)["title"] == title
    assert "default-src 'none'" in text
    assert not re.search(r"""(?:src|href)=["'](?!data:)""", text)
    assert "slider" not in data_of(text)["groups"]


def test_the_plotting_library_is_the_released_one() -> None:
    from xxhash import xxh3_128_hexdigest

    script = (PARTS / "uPlot.iife.min.js").read_bytes()
    assert script.startswith(b"/*! https://github.com/leeoniya/uPlot (v1.6.32) */")
    assert xxh3_128_hexdigest(script) == "17c1be4cf094735c11f88858399f6797"
    assert "MIT License" in (PARTS / "uPlot.LICENSE").read_text(encoding="utf-8")


def _bare(folder: Path, title: str) -> Path:
    path = folder / "bare.toml"
    path.write_text(
        f"format = 1\ntitle = {json.dumps(title)}\n[interface]\nmean_real_contact_area = '200 um^2'\n"
        "mean_junction_count = 20\n[sliding]\ndistance = '100 um'\n",
        encoding="utf-8",
    )
    return path


@pytest.mark.slow
def test_a_window_has_the_spectrum_that_theory_expects(one_way: Path) -> None:
    """Hold the page's own estimate against that of the commands, and its bins against what theory expects."""
    data = data_of(page_of(one_way))
    about = data["statistics"]["area"]
    body = """const { first, ...trace } = { first: 0, ...view.columns(view.data.groups.trace.columns) };
      const found = view.welch(trace.real_contact_area, step, ticks);
      return [Array.from(found.density), found.segments, view.strayOf(found.segments),
              Array.from(view.unpacked(expected))];"""
    density, segments, (low, high), expected = answer(data, body, **about)
    with rubnoise.open(one_way) as run:
        area = run.trace["real_contact_area"][:]
    total = WelchSum(about["ticks"], about["step"])
    total.add(area)
    assert segments == total.spectrum().segments
    assert density == pytest.approx(total.spectrum().density.tolist(), rel=1e-9, abs=1e-9)
    bins = slice(2, 40)  # beyond it leaks what is far louder
    inside = [low <= seen / mean <= high for seen, mean in zip(density[bins], expected[bins], strict=True)]
    # Of 38 bins, neighbours of which go together, 36.1 are inside on average.
    assert sum(inside) >= 38 - (1.9 + 4.0 * (38 * 0.05 * 0.95 * 1.5) ** 0.5)
    wrong = [low <= 2.0 * seen / mean <= high for seen, mean in zip(density[bins], expected[bins], strict=True)]
    assert sum(wrong) < 38 - (1.9 + 4.0 * (38 * 0.05 * 0.95 * 1.5) ** 0.5)
