"""The pages as a reader has them, in Chromium: no request, no message on the console, and the right numbers."""

import re
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any
from urllib.parse import quote

import numpy as np
import pytest

import rubnoise
from rubnoise.pages.run_view import PLANE_CELLS
from tests.lesson import walk as lesson
from tests.lesson.walk import painted, until
from tests.pages.test_reports import page_of
from tests.shell.terminal import call

TICK = 0.1


def opened(browser: Any, address: str) -> AbstractContextManager[Any]:
    """Open a page on a screen so tall that nothing has to be scrolled to."""
    return lesson.opened(browser, address, viewport={"width": 1400, "height": 1900})


@pytest.fixture(scope="module")
def address(one_way: Path, tmp_path_factory: pytest.TempPathFactory) -> str:
    path = tmp_path_factory.mktemp("page") / "run.html"
    path.write_text(page_of(one_way), encoding="utf-8")
    return path.as_uri()


def window(page: Any) -> tuple[float, float]:
    painted(page)
    found = page.evaluate("[view.window.from, view.window.to]")
    return (found[0], found[1])


def middle_of_bar(page: Any, junction: int) -> tuple[float, float]:
    """Return where on the screen the middle of a junction's bar is, by asking which bar lies under each height."""
    box = page.locator("#lifelines .u-over").bounding_box()
    start, stop = window(page)
    birth, death = page.evaluate(
        f"(() => {{ const row = view.rowOf({junction}); return [view.lives.birth_distance[row],"
        " view.lives.death_distance[row]]; })()"
    )
    across = box["x"] + box["width"] * (0.5 * (birth + death) - start) / (stop - start)
    for step in range(1, int(box["height"]) - 1, 2):
        page.mouse.click(across, box["y"] + step)
        if page.evaluate("view.chosen === null ? -1 : view.lives.junction[view.chosen]") == junction:
            return across, box["y"] + step
    raise AssertionError(f"no bar of junction {junction}")


@pytest.mark.slow
def test_a_click_on_a_bar_shows_what_the_command_says(browser: Any, address: str, one_way: Path) -> None:
    with opened(browser, f"{address}#from=100&to=140") as page:
        middle_of_bar(page, 230)
        text = page.inner_text("#life")
        told = call("junction", one_way, "230").out
        assert text.startswith("Junction 230")
        for label in ("diameter", "real contact area", "friction force  ", "death"):
            value = next(line for line in told.splitlines() if line.strip().startswith(label)).split()
            number = next(float(word) for word in value if word[0].isdigit())
            shown = [float(word) for word in re.findall(r"-?[0-9.]+(?:e[+-][0-9]+)?", text) if word != "."]
            assert min(abs(each / number - 1.0) for each in shown if each) < 1e-5, label
        assert "junction=230" in page.evaluate("location.hash")
        page.click("#others button >> nth=0")
        assert not page.inner_text("#life").startswith("Junction 230:")


@pytest.mark.slow
def test_dragging_zooms_down_to_a_tick_and_the_link_keeps_the_place(browser: Any, address: str) -> None:
    with opened(browser, f"{address}#from=100&to=140") as page:
        box = page.locator("#contact .u-over >> nth=0").bounding_box()
        page.mouse.move(box["x"] + 0.25 * box["width"], box["y"] + 20)
        page.mouse.down()
        page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 20, steps=4)
        page.mouse.up()
        start, stop = window(page)
        assert (start, stop) == pytest.approx((110.0, 120.0), abs=0.2)
        for _ in range(12):
            page.click("#zoom-in")
            painted(page)
        assert window(page)[1] - window(page)[0] == pytest.approx(TICK)
        kept = page.evaluate("location.href")
    with opened(browser, kept) as page:
        assert window(page)[1] - window(page)[0] == pytest.approx(TICK)


@pytest.mark.slow
def test_a_condition_filters_and_a_wrong_one_says_why(browser: Any, address: str, one_way: Path) -> None:
    with opened(browser, f"{address}#from=0&to=400&where={quote('diameter > 5.7 um')}") as page:
        until(page, "document.getElementById('listed').textContent !== ''")
        told = call("junctions", one_way, "--where", "diameter > 5.7 um", "--json").json()
        assert page.inner_text("#listed").startswith(f"{told['matched']['value']:,} of ")
        page.fill("#where", "diametr > 5")
        page.click("#filter button")
        assert page.inner_text("#where-problem").startswith("no column diametr")
        assert page.get_attribute("#where", "aria-invalid") == "true"
        assert page.inner_text("#listed").startswith("0 of ")
        page.fill("#where", "")
        page.click("#filter button")
        assert page.inner_text("#where-problem") == ""


@pytest.mark.slow
def test_everything_can_be_done_with_the_keyboard(browser: Any, address: str) -> None:
    with opened(browser, f"{address}#from=100&to=140") as page:
        page.focus("#charts")
        for key, expected in (("+", (110.0, 130.0)), ("ArrowRight", (115.0, 135.0)), ("-", (105.0, 145.0))):
            page.keyboard.press(key)
            assert window(page) == pytest.approx(expected)
        page.keyboard.press("n")
        first = page.inner_text("#life-title")
        page.keyboard.press("n")
        assert first.startswith("Junction ")
        assert page.inner_text("#life-title") != first
        page.fill("#number", "17")
        page.keyboard.press("Enter")
        assert page.inner_text("#life-title").startswith("Junction 17:")
        page.fill("#number", "100000")
        page.keyboard.press("Enter")
        assert page.inner_text("#number-problem") == "the run has junctions 0 to " + page.evaluate(
            "String(view.data.junctionRows - 1)"
        )
        unnamed = page.evaluate(
            "[...document.querySelectorAll('button, input')].filter((one) => !(one.textContent.trim() ||"
            " one.getAttribute('aria-label') || (one.labels && one.labels.length))).length"
        )
        assert unnamed == 0


@pytest.mark.slow
def test_a_two_way_run_shows_its_sticks_in_time(browser: Any, two_way: Path, tmp_path: Path) -> None:
    path = tmp_path / "two_way.html"
    path.write_text(page_of(two_way), encoding="utf-8")
    with rubnoise.open(two_way) as run:
        kind, time = (run.groups()["landmarks"][name][:] for name in ("kind", "time"))
    with opened(browser, f"{path.as_uri()}#from=0&to=600") as page:
        until(page, "!document.getElementById('phase').hidden")
        assert "the slider sticks" in page.inner_text(".legend")
        begins = page.evaluate("Array.from(view.unpacked(view.data.landmarks.begin))")
        assert set(time[kind == 0].tolist()) <= set(begins)
        turns = page.evaluate("Array.from(view.unpacked(view.data.landmarks.reversals.time))")
        assert turns == time[kind == 2].tolist()
        box = page.locator("#motion .u-over >> nth=0").bounding_box()
        page.mouse.move(box["x"] + 0.3 * box["width"], box["y"] + 0.5 * box["height"])
        page.mouse.down()
        page.mouse.move(box["x"] + 0.6 * box["width"], box["y"] + 0.5 * box["height"], steps=4)
        page.mouse.up()
        start, stop = window(page)
        assert 0.0 < start < stop < 600.0


def largest_in_clicks(page: Any, run: Any, *, sticks: bool) -> None:
    """Find the largest junction, the largest force and the longest stick, and who was alive then, in a click each."""
    junctions, force = run.junctions, run.trace["friction_force"][:]
    diameter, birth, death = (junctions[name][:] for name in ("diameter", "birth_distance", "death_distance"))
    row = int(np.argmax(diameter))
    page.click("#largest-junction")
    text = page.inner_text("#largest")
    assert text.startswith(f"Largest junction: {row}, diameter {float(np.float32(diameter[row])):.7g} µm")
    start, stop = window(page)
    assert start < birth[row] < death[row] < stop < start + 3.0 * (death[row] - birth[row])
    page.click("#largest-force")
    tick = int(np.argmax(force))
    place = run.trace["distance"][:][tick]
    assert f"{force[tick]:.7g} µN, at s = {place:.7g} µm" in page.inner_text("#largest")
    alive = np.flatnonzero((birth <= place) & (place < death)).tolist()
    assert page.evaluate("view.aliveAt(view.mark)") == alive
    assert f"{len(alive)} alive then" in page.inner_text("#largest")
    assert int(page.inner_text("#then button >> nth=0")) == alive[0]
    shown = page.evaluate("Math.max(...view.curve('trace', 'friction_force', view.window.from, view.window.to)[1])")
    assert shown == pytest.approx(force[tick], rel=1e-5)
    page.click("#all")
    window(page)
    whole = page.evaluate("Math.max(...view.curve('trace', 'friction_force', 0, view.data.distance)[1])")
    assert whole == force[tick]
    page.click("#undo")
    assert window(page)[0] < place < window(page)[1]
    assert page.is_visible("#longest-stick") == sticks
    if sticks:
        kind, time = (run.groups()["landmarks"][name][:] for name in ("kind", "time"))
        begins = np.flatnonzero(kind[:-1] == 0)
        longest = float((time[begins + 1] - time[begins]).max())
        page.click("#longest-stick")
        assert f"Longest stick: {longest:.7g} s" in page.inner_text("#largest")


@pytest.mark.slow
def test_a_million_junctions_are_found(browser: Any, tmp_path: Path) -> None:
    scenario = rubnoise.load("paper/fig5", ["sliding.distance=553 mm", "output.tick=1 um"])
    rubnoise.run(scenario, tmp_path / "run.h5").close()
    path = tmp_path / "page.html"
    path.write_text(page_of(tmp_path / "run.h5"), encoding="utf-8")
    assert path.stat().st_size < 20e6  # bytes
    with rubnoise.open(tmp_path / "run.h5") as run, opened(browser, path.as_uri()) as page:
        assert page.evaluate("view.lives.junction.length") == len(run.junctions) > 990_000
        largest_in_clicks(page, run, sticks=False)


def test_the_table_sorts_and_pages(browser: Any, address: str, one_way: Path) -> None:
    with rubnoise.open(one_way) as run:
        diameter = run.junctions["diameter"][:]
    falling = np.argsort(-diameter, kind="stable")
    with opened(browser, address) as page:
        page.click("#all")
        window(page)
        assert page.inner_text("#listed") == f"{diameter.size} junctions in this window: 1 to 25 below"
        page.click("#lives thead th:nth-child(4) button")
        assert page.inner_text("#lives tbody th >> nth=0") == str(falling[0])
        page.click("#page-on")
        assert page.inner_text("#lives tbody th >> nth=0") == str(falling[25])
        assert "26 to 50 below" in page.inner_text("#listed")


def test_the_statistics_of_the_whole_run_are_those_of_its_columns(browser: Any, address: str, one_way: Path) -> None:
    with rubnoise.open(one_way) as run:
        area, x, v = (np.asarray(column) for column in (run.area, run.slider.displacement, run.slider.velocity))
    with opened(browser, f"{address}#from=0&to=8") as page:
        page.select_option("#part", "whole")
        until(page, f"document.getElementById('histogram-says').textContent.startsWith(view.grouped({area.size}))")
        assert re.match(r"\d+ segments of", page.inner_text("#spectrum-says"))
        assert not page.is_hidden("#spectrum")
        assert not page.is_hidden("#phase")
        counts = page.evaluate("Array.from(view.unpacked(view.data.statistics.area.counts))")
        assert counts == np.histogram(area, len(counts), (area.min(), area.max()))[0].tolist()
        plane = page.evaluate("Array.from(view.unpacked(view.data.statistics.phase.counts))")
        ends = ((x.min(), x.max()), (v.min(), v.max()))
        assert plane == np.histogram2d(x, v, PLANE_CELLS, ends)[0].T.ravel().tolist()


@pytest.mark.slow
def test_a_sweep_shows_its_runs(browser: Any, sweep_folder: Path, tmp_path: Path) -> None:
    path = tmp_path / "sweep.html"
    assert call("view", sweep_folder, "-o", path).code == 0
    with opened(browser, path.as_uri()) as page:
        assert page.inner_text("h1") == "few <b>points</b>"
        assert page.inner_text("#holds") == "6 done"
        page.click("#runs tbody button >> nth=2")
        title = page.inner_text("#run-title")
        run = title.removeprefix("Run ")
        with rubnoise.open_sweep(sweep_folder) as sweep:
            row = sweep.runs["run_id"][:].tolist().index(run)
            figure = sweep.runs["real_contact_area_std"][:][row]
        assert f"{figure:.7g}" in page.inner_text("#figures")
        assert page.locator("#beginning canvas").count() == 2
        assert page.locator("#spectra-legend span").count() == 3  # a run of each point
        assert page.is_hidden("#map")  # one key
        page.check("#y-log")
        kept = page.evaluate("location.href")
    with opened(browser, kept) as page:
        assert page.inner_text("#run-title") == title
        assert page.is_checked("#y-log")


def test_a_page_of_free_motion_shows_flights_and_goes_to_the_hardest_impact(
    browser: Any, bouncing: Path, tmp_path: Path
) -> None:
    path = tmp_path / "bouncing.html"
    path.write_text(page_of(bouncing), encoding="utf-8")
    with rubnoise.open(bouncing) as run:
        landmarks = run.groups()["landmarks"]
        made = landmarks["kind"][:] == 5
        speeds, places = landmarks["impact_speed"][:][made], landmarks["distance"][:][made]
        ticks = run.trace["junction_count"].shape[0]
        off = 100.0 * float(np.mean(run.trace["junction_count"][:] == 0))
        touch = int(np.argmax(run.junctions["diameter"][:]))
        overlap = float(run.junctions["max_overlap"][touch])
    with opened(browser, path.as_uri()) as page:
        page.click("#hardest-impact")
        start, stop = window(page)
        assert start < places[np.argmax(speeds)] < stop
        assert f"{speeds.max():.6g}"[:6] in page.inner_text("#largest").replace(",", "")
        page.click("#largest-junction")
        assert page.inner_text("#life-title").startswith(f"Touch {touch}")
        assert f"{float(f'{overlap:.4f}'):g}" in page.inner_text("#life-figures")
        assert page.locator("#life-curve").is_hidden()
        assert "touches in this window" in page.inner_text("#listed")
        assert page.inner_text("#lives thead th").startswith("touch")
        page.click("#all")
        page.select_option("#counted", "load")
        until(page, f"document.getElementById('histogram-says').textContent.startsWith(view.grouped({ticks}))")
        said = re.search(r"in ([0-9.]+) % of them the slider is off the surface", page.inner_text("#histogram-says"))
        assert said is not None
        assert abs(float(said[1]) - off) < 0.06
        heard = page.locator("#heard option").evaluate_all(
            "all => all.filter(one => !one.disabled).map(one => one.value)"
        )
        assert heard == ["area", "normal", "load"]
        curves = page.locator("#contact .chart").evaluate_all("all => all.map(one => one.dataset.curve)")
        assert curves[-3:] == ["load", "separation", "normal_velocity"]


def test_a_page_opens_in_a_frame_of_a_site(browser: Any, address: str, tmp_path: Path) -> None:
    (tmp_path / "site.html").write_text(f'<iframe src="{address}"></iframe>', encoding="utf-8")
    page, trouble = browser.new_page(), []
    page.on("pageerror", lambda error: trouble.append(str(error)))
    page.goto((tmp_path / "site.html").as_uri())
    until(page.frames[1], "document.querySelector('#overview canvas') !== null")
    assert trouble == []
    page.close()


def test_two_runs_side_by_side_share_their_window(
    browser: Any, one_way: Path, off_centre: Path, tmp_path: Path
) -> None:
    path = tmp_path / "both.html"
    assert call("page", one_way, off_centre, "-o", path).code == 0
    with opened(browser, path.as_uri()) as page:
        assert page.locator("p").all_inner_texts() == [str(one_way), str(off_centre)]
        frames = page.frames[1:]
        for frame in frames:
            until(frame, "view.charts !== undefined || document.querySelector('#overview canvas') !== null")
        frames[0].click("#zoom-in")
        first = frames[0].evaluate("[view.window.from, view.window.to]")
        until(frames[1], f"view.window.to === {first[1]}")
        frames[1].click("#on")
        second = frames[1].evaluate("[view.window.from, view.window.to]")
        assert second != first
        until(frames[0], f"view.window.from === {second[0]} && view.window.to === {second[1]}")
        for frame in frames:
            until(frame, "document.querySelectorAll('.chart').length > 0")
        scale = "view.pixelOf('trace', 'real_contact_area')"
        for _ in range(200):  # each is drawn again when it hears of the other's range
            if frames[0].evaluate(scale) == frames[1].evaluate(scale):
                break
            page.wait_for_timeout(50)
        else:
            pytest.fail("the axes of the two differ")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("one.h5 one.h5 one.h5", "a page shows one result, or two side by side"),
        ("one.h5 one.h5 --as report", "only two results are shown side by side, with --as view"),
        ("--as view", "--as view needs a result"),
        ("one.toml --from 1mm", "--from and --to are for the view of a run"),
        ("one.h5 -o one.txt", "one.txt does not end in .html"),
    ],
)
def test_pages_that_cannot_be_are_refused(
    words: str, said: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    answer = call("page", *words.split())
    assert (answer.code, answer.out) == (2, "")
    assert said in answer.err
    assert not any(tmp_path.iterdir())
