"""Contacts beside each other, sections, and a stage that stays in sight."""

from collections.abc import Callable, Iterator
from math import sqrt
from typing import Any

import numpy as np
import pytest

import rubnoise
from rubnoise.contact.overlap import junction_area
from tests.lesson.node import lessons, scenario_of
from tests.lesson.walk import CALM, UNHURRIED, Walk, opened, until

# Contacts beside each other on equal axes, the trace over itself, thirty swings, and a picture without stripes.
COLUMNS = 480
PAIRS = {"2. Births": (0, 1), "5. The sum": (0, 2), "8. Many small": (0, 1)}
SIDES = """(() => {
  rub.fitAll();
  rub.beside.draw();
  return rub.beside.sides.map((side) => side && {
    areas: Array.from({ length: 400 }, (_, i) => side.area(side.next - 400 + i)),
    first: side.next - 400, spacing: side.spacing, top: side.top, looks: side.looks,
    counts: [...side.counts], births: side.births,
  });
})()"""
STAGE = """rub.run.living.map((row) => [
  row.id, ...rub.stage.placeOf(row), row.diameter, rub.stage.along(row),
])"""
ROWS = "rub.run.rows.map((row) => [row.birth, row.diameter])"
MEMORY = """(lives) => {
  document.getElementById('lag').value = lives;
  document.getElementById('lag').dispatchEvent(new Event('input'));
  return { ticks: rub.shifted.ticks(), lag: rub.shifted.lag(), found: rub.shifted.correlation() };
}"""
BARE = """(() => {
  const { canvas, scale, height, width } = rub.traces.pens.area;
  rub.traces.draw(rub.run.moments());
  const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext('2d', { willReadFrequently: true });
  copy.drawImage(canvas, 0, 0);
  const box = rub.traces.boxOf({ width, height });
  const left = Math.round(box.left * scale) + 2;
  const [wide, low] = [Math.round(box.right * scale) - left - 4, Math.round(box.bottom * scale) - 4];
  const { data } = copy.getImageData(left, low, wide, 1);
  let bare = 0;
  for (let i = 3; i < data.length; i += 4) bare += data[i] < 40;
  return bare;
})()"""
"""Pixels of the area's lower edge where no layer of the stack is drawn."""
EMPTY = "rub.stack.begin(rub.stack.width, rub.stack.height, rub.stack.top, rub.stack.spacing)"


@pytest.fixture
def walk(browser: Any, lesson_file: str) -> Iterator[Walk]:
    """Return a walk through a page that stands still until a run is pressed."""
    with opened(browser, lesson_file, init=UNHURRIED, **CALM) as page:
        yield Walk(page)


@pytest.mark.parametrize("title", PAIRS)
def test_contacts_stand_beside_each_other_on_equal_axes(walk: Walk, title: str) -> None:
    first, second = PAIRS[title]
    walk.open(title)
    assert walk.page.locator("#beside").is_hidden()
    walk.predict()
    walk.run(first)
    walk.page.evaluate("rub.run.pause()")
    sides = walk.page.evaluate(SIDES)
    assert sides[first] is not None
    assert sides[second] is None, "what is not run yet gives nothing away"
    for run in (first, second):
        walk.run(run)
        walk.page.evaluate("rub.run.pause(), rub.run.goTo(300)")
        sides = walk.page.evaluate(SIDES)
    few, many = sides[first], sides[second]
    assert walk.page.locator("#beside").is_visible()
    assert (few["spacing"], few["top"]) == (many["spacing"], many["top"])
    places = (many["first"] + np.arange(400)) * many["spacing"]
    for run, side, other in ((first, few, many), (second, many, few)):
        walk.run(run)
        walk.page.evaluate("rub.run.pause(), rub.run.goTo(300)")
        birth, diameter = np.array(walk.page.evaluate(ROWS)).T
        age = places[:, None] - birth
        areas = np.where((age > 0) & (age < 2 * diameter), junction_area(age, diameter), 0.0).sum(axis=1)
        np.testing.assert_allclose(side["areas"], areas, rtol=1e-9, atol=1e-9)
        assert np.abs(np.array(other["areas"]) - areas).max() > 1.0
        seen = birth[(birth > 0) & (birth >= side["births"][0]) & (birth <= side["births"][-1])]
        assert side["births"] == seen.tolist()
        assert side["births"][0] < places[80]


def test_a_jump_far_ahead_shows_what_a_slow_run_does(walk: Walk) -> None:
    walk.open("8. Many small")
    walk.predict()
    walk.run(1)
    walk.page.evaluate("rub.run.pause(), rub.run.goTo(2000)")
    there = walk.page.evaluate(SIDES)[1:]
    walk.page.evaluate("rub.run.goTo(0)")
    for place in range(100, 2001, 100):
        walk.page.evaluate(f"rub.run.goTo({place}), rub.beside.draw()")
    slowly = walk.page.evaluate(SIDES)[1:]
    assert slowly == there
    for side in slowly:
        assert side["looks"] == sum(side["counts"]) == int(2000 / side["spacing"]) // 8 + 1
    walk.page.evaluate("rub.run.goTo(1000)")
    assert walk.page.evaluate(SIDES)[1:] != there


def test_a_run_stays_when_another_one_runs(walk: Walk) -> None:
    """Picture and column of a run stay; a control that is turned writes into a column of its own."""
    walk.open("5. The sum")
    walk.predict()
    column = "[...document.querySelectorAll(\"[data-seen^='%d.']\")].map((cell) => cell.textContent)"
    kept: list[Any] = []
    for run, count in enumerate((2, 20, 100)):
        walk.run(run)
        walk.page.evaluate("rub.run.pause()")
        walk.slide_on()
        sides = walk.page.evaluate(SIDES)
        assert [side is not None for side in sides] == [i <= run for i in range(3)], count
        assert sides[:run] == [side for side, _ in kept]
        assert [walk.page.evaluate(column % i) for i in range(run)] == [figures for _, figures in kept]
        kept.append((sides[run], walk.page.evaluate(column % run)))
    walk.page.evaluate("rub.set({ meanCount: 50 }), rub.run.goTo(500)")
    assert "controls as they are" in walk.article.locator(".lesson-table").inner_text()
    assert [walk.page.evaluate(column % i) for i in range(3)] == [figures for _, figures in kept]


def test_hills_of_one_surface_do_not_overlap_and_births_at_random_form_no_lattice(walk: Walk) -> None:
    """Of random places x is uniform, and does not follow from that of the row before."""
    walk.page.evaluate("rub.set({ meanCount: 40, spread: 0.5 })")
    found: dict[int, list[float]] = {}
    worst = 0.0
    for place in range(20, 1500, 2):
        rows = np.array(walk.page.evaluate(f"rub.run.goTo({place}), {STAGE}"))
        found |= {int(row[0]): list(row[1:3]) for row in rows}
        _, x, y, diameter, along = rows.T
        for way in (-0.5, 0.5):
            apart = np.hypot(*(each[:, None] - each for each in (x + way * along, y)))
            overlap = 0.5 * (diameter[:, None] + diameter) - apart
            np.fill_diagonal(overlap, -np.inf)
            worst = max(worst, overlap.max() / diameter.mean())
    assert worst <= 0.02, "in diameters"
    places = np.array([found[row] for row in sorted(found)])
    share = (places - places.min(axis=0)) / np.ptp(places, axis=0)
    assert len(share) > 2000
    assert np.abs(share.mean(axis=0) - 0.5).max() < 4 * sqrt(1 / 12 / len(share))
    step = np.diff(share, axis=0) % 1
    assert step.std(axis=0).min() > 0.2, "a low-discrepancy sequence has one step"


def test_the_correlation_at_a_lag_is_that_of_the_trace(walk: Walk) -> None:
    walk.open("6. Memory")
    walk.predict()
    walk.run()
    walk.page.evaluate("rub.run.pause(), rub.run.goTo(2000)")
    area = np.array(walk.page.evaluate("[...rub.run.trace.area.slice(0, rub.run.ticksSeen + 1)]"))
    life, tick, mean = walk.page.evaluate("[rub.exact().lifeMean, rub.run.trace.tick, rub.exact().areaMean]")
    left = area - mean

    def correlation(ticks: int) -> float:
        return float(np.mean(left[ticks:] * left[: left.size - ticks]) / np.mean(left**2))

    for lives in (0.0, 0.25, 0.5, 1.0, 1.25):
        told = walk.page.evaluate(MEMORY, lives)
        assert told["ticks"] == pytest.approx(lives * life / tick, abs=0.5)
        assert told["lag"] == told["ticks"] * tick
        assert told["found"] == pytest.approx(correlation(told["ticks"]), abs=0.005)  # between two lags by a line
        if 0.0 < lives < 0.9:
            assert abs(correlation(told["ticks"] + 8) - told["found"]) > 0.01


def test_the_trace_lies_over_itself_once_it_has_been_predicted(walk: Walk) -> None:
    walk.open("6. Memory")
    assert walk.page.locator("#shifted").is_hidden()
    walk.predict()
    walk.run()
    walk.page.evaluate("rub.run.pause(), rub.run.goTo(500), rub.fitAll()")
    picture = "rub.shifted.draw(rub.run.moments()), document.getElementById('shifted').toDataURL()"
    said = "document.getElementById('lag-said').textContent.includes"
    before = walk.page.evaluate(picture)
    assert walk.page.evaluate(picture) == before
    assert walk.page.locator("#shifted").is_visible()
    until(walk.page, f"{said}('0.25 lives, 2.71 µm: correlation 0.6')")
    walk.page.locator("#lag").focus()
    walk.page.keyboard.press("End")
    until(walk.page, f"{said}('1.25 lives')")
    assert walk.page.evaluate(picture) != before


def test_thirty_swings_are_on_show(walk: Walk) -> None:
    walk.open("7. The slider")
    walk.predict()
    walk.run()
    walk.page.evaluate("rub.run.pause(), rub.run.goTo(3000)")
    begin, end = walk.page.evaluate("rub.traces.longStretch()")
    world = walk.page.evaluate("rub.world")
    frequency = rubnoise.exact(scenario_of(world)).model.slider.natural_frequency
    assert (end - begin) / world["speed"] * frequency == pytest.approx(30.0, rel=1e-9)
    motion = walk.page.evaluate("[...rub.run.trace.displacement.slice(0, rub.run.ticksSeen + 1)]")
    tick = walk.page.evaluate("rub.run.trace.tick")
    shown = np.array(motion)[int(begin / tick) :]
    crossings = np.count_nonzero(np.diff(np.signbit(shown - shown.mean())))
    assert abs(crossings - 60) <= 8, "two crossings of the mean for each swing"


@pytest.mark.parametrize("count", [20, 400])
def test_a_jump_leaves_no_stripe(walk: Walk, count: int) -> None:
    """Layers are kept in a ring; what is drawn in strides after a jump ends at the ring's edge."""
    walk.page.evaluate(f"rub.set({{ meanCount: {count} }}), rub.show('area'), rub.fitAll()")
    for place in (400, 500.3, 502, 607.7, 700.1, 800.6):
        walk.page.evaluate(f"rub.run.goTo({place}), {EMPTY}")
        assert walk.page.evaluate(BARE) == 0, place
    walk.page.evaluate("rub.stack.until = () => {}")
    walk.page.evaluate(EMPTY)
    assert walk.page.evaluate(BARE) > 100, "layers that are missing would be noticed"


# The stage stays in sight while a lesson is played, on projectors, desks and phones.
SCREENS = {1024: 768, 1366: 768, 1440: 900, 1920: 1080, 390: 844}
LEAST = 0.6  # of the stage
TITLES = tuple(lesson.title for lesson in lessons())
IN_SIGHT = """(() => {
  const stage = document.getElementById('stage');
  const box = stage.getBoundingClientRect();
  const rows = Array.from({ length: 20 }, (_, i) => box.top + ((i + 0.5) / 20) * box.height);
  const columns = Array.from({ length: 5 }, (_, i) => box.left + ((i + 0.5) / 5) * box.width);
  const seen = rows.flatMap((y) => columns.map((x) => document.elementFromPoint(x, y) === stage));
  return seen.filter(Boolean).length / seen.length;
})()"""
"""Share of the stage that the window shows and that nothing else covers."""


def play(page: Any, titles: tuple[str, ...] = TITLES) -> dict[str, float]:
    """Play every lesson to its checks; return the share of the stage in sight after each press."""
    walk = Walk(page)
    found = {}
    for opened_title in titles:

        def press(name: str, act: Callable[[], object], title: str = opened_title) -> None:
            act()
            found[f"{title}: {name}"] = page.evaluate(IN_SIGHT)

        press("open", lambda title=opened_title: walk.open(title))
        press("predict", walk.predict)
        for run in range(walk.article.locator("[data-run]").count()):
            press(f"run {run}", lambda run=run: walk.run(run))
            press(f"ahead {run}", walk.slide_on)
        press("look", walk.say)
        press("law", walk.article.locator("#lesson-why summary").click)
        for question in range(walk.forms.count()):
            press(f"check {question}", walk.forms.nth(question).get_by_role("button", name="Check").click)
    return found


@pytest.mark.parametrize("width", SCREENS)
def test_the_stage_is_in_sight_after_every_press(browser: Any, lesson_file: str, width: int) -> None:
    screen = {"width": width, "height": SCREENS[width]}
    with opened(browser, lesson_file, init=UNHURRIED, viewport=screen, **CALM) as page:
        shares = play(page)
        assert len(shares) > 7 * len(TITLES)
        assert {run: share for run, share in shares.items() if share < LEAST} == {}


def test_a_stage_that_is_scrolled_away_would_be_noticed(browser: Any, lesson_file: str) -> None:
    with opened(browser, lesson_file, init=UNHURRIED, viewport={"width": 390, "height": 844}, **CALM) as page:
        page.evaluate("document.getElementById('pictures').style.position = 'static'")
        page.evaluate("Element.prototype.scrollIntoView = () => {}")
        assert min(play(page, TITLES[1:3]).values()) < LEAST


def test_all_traces_unfold_under_the_stage(browser: Any, lesson_file: str) -> None:
    with opened(browser, lesson_file, init=UNHURRIED, viewport={"width": 1366, "height": 768}, **CALM) as page:
        walk = Walk(page)
        walk.to_the_checks()
        assert page.locator("#force").is_hidden()
        page.locator("#unfold").click()
        for name in ("area", "count", "force", "slider", "panel-canvas"):
            page.locator(f"#{name}").scroll_into_view_if_needed()
            assert page.evaluate(IN_SIGHT) >= LEAST, name
        ends = "['area', 'count', 'force'].map((id) => document.getElementById(id).getBoundingClientRect().right)"
        assert len({round(end) for end in page.evaluate(ends)}) == 1, "a bump in area stands over its bump in force"


def test_a_phone_has_the_lesson_on_its_first_screen(browser: Any, lesson_file: str) -> None:
    with opened(browser, lesson_file, init=UNHURRIED, viewport={"width": 390, "height": 844}, **CALM) as page:
        top = page.locator(".lesson-question").bounding_box()["y"]
        assert top < 0.6 * 844
        assert page.locator("#knobs").bounding_box()["y"] > top


# The surfaces from the side: hills of the circles that the dotted line cuts, which meet where the circles overlap.
SIDE = """(() => {
  const { stage, run } = rub;
  const along = (row) => run.distance - 0.5 * (row.birth + row.death);
  const rows = run.living.map((row) => [...stage.placeOf(row), row.diameter, along(row), row.offset]);
  return { rows, cut: stage.cut(), scale: stage.scale, hills: rub.section.hills() };
})()"""


def touching(hill: dict[str, float]) -> float:
    """Return the length along which the tops of a pair of hills meet, in pixels."""
    if not (hill["halfBelow"] and hill["halfAbove"]):
        return 0.0
    left = max(hill["below"] - hill["halfBelow"], hill["above"] - hill["halfAbove"])
    return max(0.0, min(hill["below"] + hill["halfBelow"], hill["above"] + hill["halfAbove"]) - left)


@pytest.mark.parametrize("knobs", ["meanCount=1", "meanCount=20", "meanCount=60", "meanCount=60&offset=uniform"])
def test_hills_touch_along_the_chords_that_two_circles_share(browser: Any, lesson_file: str, knobs: str) -> None:
    met = 0
    with opened(browser, f"{lesson_file}#{knobs}", init=UNHURRIED, **CALM) as page:
        assert page.locator("#section").is_visible()
        for place in (50.0, 77.7, 300.3):
            page.evaluate(f"rub.run.goTo({place})")
            side = page.evaluate(SIDE)
            x, y, diameter, along, across = np.array(side["rows"]).reshape(-1, 5).T
            # The lower circle lies half of both distances back and up, the upper one as far on and down.
            ends = []
            for way in (-0.5, 0.5):
                half = 0.5 * np.sqrt(np.maximum(0.0, diameter**2 - 4.0 * (y + way * across - side["cut"]) ** 2))
                ends.append((x + way * along - half, x + way * along + half, half))
            (left, right, below), (from_left, to_right, above) = ends
            length = np.minimum(right, to_right) - np.maximum(left, from_left)
            met_here = (length > 0) & (below > 0) & (above > 0)
            shared = np.sort(length[met_here]) * side["scale"]
            found = sorted(part for part in map(touching, side["hills"]) if part > 0)
            np.testing.assert_allclose(found, shared, rtol=1e-9)
            middles = {round(0.5 * (hill["above"] + hill["below"]), 6) for hill in side["hills"]}
            assert {round(each, 6) for each in (x * side["scale"])[(below > 0) | (above > 0)]} <= middles
            met += shared.size
    assert met > 0


def test_the_cut_goes_through_the_junction_that_is_chosen(browser: Any, lesson_file: str) -> None:
    with opened(browser, lesson_file, init=UNHURRIED, **CALM) as page:
        page.evaluate("rub.run.goTo(60)")
        middle = page.evaluate("rub.stage.cut()")
        page.evaluate("rub.select(rub.run.living[2].id)")
        assert page.evaluate("rub.stage.cut()") == page.evaluate("rub.stage.placeOf(rub.run.living[2])[1]") != middle
        Walk(page).predict()
        Walk(page).open("2. Births")
        Walk(page).predict()
        Walk(page).run()
        assert page.locator("#section").is_hidden(), "a lesson's own picture takes its place"
