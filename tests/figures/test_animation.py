"""Films show the junctions of a run where they overlap, and the area that they add up to."""

from collections.abc import Iterator
from dataclasses import replace
from io import BytesIO
from itertools import combinations, pairwise
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

import rubnoise
from rubnoise.analysis.selection import Neighbours, neighbours
from rubnoise.errors import Refused, RubnoiseError
from rubnoise.figures import animation, film, style
from rubnoise.figures import stage as staging
from rubnoise.figures.animation import Film
from rubnoise.figures.film import check_film, write_film
from rubnoise.figures.stage import BORN, LEAD, MOST_AT_ONCE, Stage, shades, stage_of
from rubnoise.figures.stretch import Stretch
from rubnoise.storage.reader import open_run

SCENARIO: dict[str, Any] = {
    "format": 1,
    "title": "a contact",
    "interface": {"mean_real_contact_area": 200.0, "mean_junction_count": 20},
    "diameter": {"law": "normal", "spread": "0.4 um"},
    "sliding": {"distance": 400.0},
    "output": {"tick": "0.1 um"},
}
FAKE = """#!/bin/sh
for last; do :; done
printf '%s\\n' "$*" > "$0.asked"
wc -c > "$last"
"""
BROKEN = """#!/bin/sh
echo "first" >&2
echo "no such encoder" >&2
exit 3
"""


@pytest.fixture(scope="module")
def stretch(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Stretch]:
    path = tmp_path_factory.mktemp("film") / "run.h5"
    rubnoise.run(rubnoise.build(SCENARIO), path, seed=3).close()
    with open_run(path) as file:
        yield Stretch.of(file)


@pytest.fixture(scope="module")
def stage(stretch: Stretch) -> Stage:
    return stage_of(neighbours(stretch.file, -1, 100.0, 200.0), 3.6)


def _short(stretch: Stretch, frames: int = 4) -> Film:
    return Film.of(Stretch.of(stretch.file, 100.0, 130.0), seconds=frames / 10.0, rate=10)


def _area_of(outline: np.ndarray) -> float:
    x, y = outline.T
    return abs(0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))))


def test_the_lens_that_is_drawn_has_the_area_of_the_junction(stage: Stage) -> None:
    pairs = stage.junctions
    for row in range(5):
        diameter = float(pairs.diameter[row])
        for since in (0.1, 0.5, 1.0, 1.7):
            outline = stage._lens(row, (since - 1.0) * diameter)
            exact = float(pairs.pulse.area(np.array([since * diameter]), np.array([diameter]))[0])
            assert _area_of(outline) == pytest.approx(exact, rel=0.01)


def test_the_lens_lies_in_both_circles(stage: Stage) -> None:
    radius = 0.5 * float(stage.junctions.diameter[0])
    for shift in (-1.3 * radius, 0.0, 0.4 * radius):
        away = stage._lens(0, shift) - [stage.x[0], stage.y[0]]
        for centre in (0.0, shift):
            assert np.hypot(away[:, 0] - centre, away[:, 1]).max() <= radius * (1.0 + 1e-9)


def test_nobody_shares_a_place_with_somebody_who_is_there(stage: Stage) -> None:
    pairs = stage.junctions
    lead = LEAD * pairs.diameter
    begins, ends = pairs.birth - lead, pairs.death + lead
    places = list(zip(stage.x.tolist(), stage.y.tolist(), strict=True))
    assert len(set(places)) < len(places)  # places are used again
    for i, j in combinations(range(len(places)), 2):
        if places[i] == places[j]:
            assert ends[i] <= begins[j] or ends[j] <= begins[i]


def test_every_pair_is_inside_the_stage(stage: Stage) -> None:
    reach = (1.5 + LEAD) * stage.junctions.diameter
    assert np.all(stage.y - 0.5 * stage.junctions.diameter > 0.0)
    assert np.all(stage.y + 0.5 * stage.junctions.diameter < stage.height)
    assert np.all(stage.x - reach > 0.0)
    assert np.all(stage.x + reach < stage.width)
    assert 2.0 < stage.width / stage.height < 6.0


def _alike(count: int, pairs: Neighbours) -> Neighbours:
    names = ("rows", "birth", "death", "diameter")
    return replace(pairs, **{name: np.repeat(getattr(pairs, name)[:1], count) for name in names})


def test_a_crowd_is_refused(stage: Stage) -> None:
    assert stage_of(_alike(MOST_AT_ONCE, stage.junctions), 3.6).x.size == MOST_AT_ONCE
    with pytest.raises(Refused, match="401 junctions are there at once, of which a film shows 400 at most"):
        stage_of(_alike(MOST_AT_ONCE + 1, stage.junctions), 3.6)


def test_a_great_crowd_is_refused_before_anyone_is_placed(stage: Stage, monkeypatch: pytest.MonkeyPatch) -> None:
    """To place each of many takes a time that grows with their square."""
    monkeypatch.setattr(staging, "_places", lambda *_: pytest.fail("junctions are being placed"))
    with pytest.raises(Refused, match="1,000,000 junctions are there at once"):
        stage_of(_alike(1_000_000, stage.junctions), 3.6)


@pytest.mark.parametrize("seed", range(5))
def test_as_many_are_there_at_once_as_need_places(seed: int) -> None:
    """Also if some begin where others end."""
    drawn = np.random.default_rng(seed)
    begins = drawn.integers(0, 30, 40).astype(float)
    ends = begins + drawn.integers(1, 9, 40)
    assert staging._most_at_once(begins, ends) == staging._places(begins, ends).max() + 1


def test_nobody_at_all_is_a_stage_too(stage: Stage) -> None:
    empty = stage_of(_alike(0, stage.junctions), 3.6)
    assert empty.x.size == 0
    assert empty.width > 0.0


def test_shades_go_from_light_to_dark() -> None:
    lightness = shades(50).astype(float).sum(axis=1)
    assert np.all(np.diff(lightness) < 0.0)


def test_frames_go_from_the_start_to_the_end_of_the_stretch(stretch: Stretch) -> None:
    short = _short(stretch)
    assert short.distances.tolist() == pytest.approx([100.0, 110.0, 120.0, 130.0])
    frames = list(short.frames())
    assert len(frames) == 4
    assert all(frame.shape == (540, 960, 3) and frame.dtype == np.uint8 for frame in frames)
    assert all(np.any(before != after) for before, after in pairwise(frames))


def test_a_frame_tells_how_many_are_alive_and_their_area(stretch: Stretch, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[tuple[float, float, str]] = []
    monkeypatch.setattr(animation._Growing, "show", lambda _, *values: seen.append(values))
    list(_short(stretch).frames())
    for (distance, area, _), (_, count, words) in zip(seen[::2], seen[1::2], strict=True):
        row = round(distance / stretch.model.tick)
        assert area == pytest.approx(stretch.file.column("trace", "real_contact_area")[row], rel=1e-9)
        assert count == stretch.file.column("trace", "junction_count")[row]
        assert words == f"{count:.0f} alive"


def test_a_frame_is_the_same_whichever_was_drawn_before(stretch: Stretch) -> None:
    """What a film draws once and keeps holds nothing that changes, such as the words above a pane."""
    forward = _short(stretch)
    backward = replace(forward, distances=forward.distances[::-1], labels=forward.labels[::-1])
    for one, other in zip(forward.frames(), reversed(list(backward.frames())), strict=True):
        assert np.array_equal(one, other)


def test_the_trace_grows(stretch: Stretch) -> None:
    blue = np.array([int(style.BLUE[i : i + 2], 16) for i in (1, 3, 5)])
    grown = [int(np.all(frame[300:] == blue, axis=2).sum()) for frame in _short(stretch).frames()]
    assert grown == sorted(grown)
    assert grown[-1] > 3 * max(grown[0], 1)


def test_areas_of_the_stage_add_up_to_the_number(stretch: Stretch) -> None:
    """As many pixels are blue above as the area says, in the scale of the stage."""
    short = _short(stretch)
    frame = next(iter(short.frames()))[60:340, :880].astype(int)  # without the key beside it
    coloured = (frame[:, :, 2] - frame[:, :, 0] > 20).sum()
    scale = 840.0 / short.stage.width  # pixels an um at most: the stage is as wide as the picture, or narrower
    area = float(short.stage.junctions.alive(100.0).area(100.0).sum())
    assert 0.4 < coloured / (area * scale**2) < 1.0


def test_births_and_deaths_have_their_signs_where_circles_touch(stage: Stage) -> None:
    pairs = stage.junctions
    for event, lasting, side, marker in ((pairs.birth, BORN, -0.5, "o"), (pairs.death, LEAD, 0.5, "x")):
        row = int(np.argmax(event > 120.0))
        for since, shown in ((0.0, True), (0.9 * lasting, True), (1.1 * lasting, False), (-0.1, False)):
            with style.house_style():
                axes = style.new_figure(3.0, 2.0).subplots()
                drawn = stage.draw(axes, float(event[row] + since * pairs.diameter[row]))
            signs = next(each for each in drawn if getattr(each, "get_marker", lambda: "")() == marker)
            where = np.column_stack(signs.get_data())
            wanted = [stage.x[row] + side * pairs.diameter[row], stage.y[row]]
            assert bool(np.any(np.all(np.isclose(where, wanted), axis=1))) is shown


def test_a_frame_has_a_key_of_colours_and_signs(stretch: Stretch, monkeypatch: pytest.MonkeyPatch) -> None:
    figures: list[Any] = []
    made = animation.new_figure
    monkeypatch.setattr(animation, "new_figure", lambda *size: figures.append(made(*size)) or figures[-1])
    next(iter(_short(stretch).frames()))
    texts: set[str] = set()
    for axes in figures[0].axes:
        legend = axes.get_legend()
        texts |= {text.get_text() for text in legend.get_texts()} if legend is not None else {axes.get_ylabel()}
    assert {"birth", "death", "area of a junction (µm²)", "live junctions"} <= texts


def test_without_a_choice_the_first_three_lives_are_shown(stretch: Stretch) -> None:
    shown = Film.of(stretch, seconds=1.0, rate=10).stretch
    assert (shown.start, shown.stop) == (0.0, pytest.approx(3.0 * stretch.model.mean_life_distance))


@pytest.mark.parametrize(("seconds", "rate"), [(0.1, 10), (101.0, 10)])
def test_too_few_or_too_many_frames_are_refused(stretch: Stretch, seconds: float, rate: int) -> None:
    with pytest.raises(Refused, match=r"frames; 2 to 1,000 can be made"):
        Film.of(stretch, seconds=seconds, rate=rate)


def test_a_gif_lasts_as_long_as_it_should_and_repeats(stretch: Stretch, tmp_path: Path) -> None:
    made = Film.of(Stretch.of(stretch.file, 100.0, 130.0), seconds=1.0, rate=12)
    write_film(tmp_path / "a", made, "gif", lambda: None)
    with Image.open(tmp_path / "a") as gif:
        durations = []
        for i in range(gif.n_frames):
            gif.seek(i)
            durations.append(gif.info["duration"])
        assert (gif.n_frames, gif.size, gif.info["loop"]) == (12, (960, 540), 0)
    assert sum(durations) == 1000
    assert set(durations) == {80, 90}


def test_a_gif_has_the_same_bytes_each_time_and_a_white_ground(stretch: Stretch, tmp_path: Path) -> None:
    for name in "ab":
        write_film(tmp_path / name, _short(stretch), "gif", lambda: None)
    data = (tmp_path / "a").read_bytes()
    assert data == (tmp_path / "b").read_bytes()
    with Image.open(BytesIO(data)) as gif:
        for i in range(gif.n_frames):
            gif.seek(i)
            shown = np.asarray(gif.convert("RGB"))
            assert np.all(shown[:, :3] == 255)
            assert np.abs(shown.astype(int) - list(_short(stretch).frames())[i]).mean() < 3.0


def _ffmpeg(folder: Path, text: str, monkeypatch: pytest.MonkeyPatch) -> Path:
    tool = folder / "ffmpeg"
    tool.write_text(text, encoding="utf-8")
    tool.chmod(0o755)
    monkeypatch.setenv("PATH", f"{folder}:/usr/bin:/bin")
    return tool


def test_an_mp4_is_made_by_ffmpeg_of_raw_frames(
    stretch: Stretch, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    tool = _ffmpeg(tmp_path, FAKE, monkeypatch)
    check_film("mp4")
    write_film(tmp_path / "a", _short(stretch), "mp4", lambda: None)
    assert int((tmp_path / "a").read_text()) == 4 * 960 * 540 * 3
    asked = Path(f"{tool}.asked").read_text()
    assert "-pix_fmt rgb24 -s 960x540 -r 10 -i -" in asked
    assert asked.endswith(f"-f mp4 {tmp_path / 'a'}\n")


def test_what_ffmpeg_says_is_passed_on(stretch: Stretch, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _ffmpeg(tmp_path, BROKEN, monkeypatch)
    with pytest.raises(RubnoiseError, match=r"^ffmpeg failed: no such encoder$"):
        write_film(tmp_path / "a", _short(stretch), "mp4", lambda: None)


def test_without_ffmpeg_there_is_no_mp4(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    check_film("gif")
    with pytest.raises(Refused, match="an mp4 needs ffmpeg, which is not installed here; a gif needs nothing more"):
        check_film("mp4")


def test_ffmpeg_makes_a_film_that_it_reads_itself(stretch: Stretch, tmp_path: Path) -> None:
    if film.shutil.which("ffmpeg") is None:
        pytest.skip("ffmpeg is not here to make an mp4")
    write_film(tmp_path / "a.mp4", _short(stretch), "mp4", lambda: None)
    said = film.subprocess.run(
        ["ffmpeg", "-i", tmp_path / "a.mp4", "-f", "null", "-"], capture_output=True, text=True, check=True
    ).stderr
    assert "960x540" in said
    assert "h264" in said


def test_what_is_raised_between_frames_stops_the_film(stretch: Stretch, tmp_path: Path) -> None:
    calls: list[int] = []

    def stop() -> None:
        calls.append(1)
        if len(calls) == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_film(tmp_path / "a", _short(stretch), "gif", stop)


def test_a_disc_in_full_overlap_is_a_whole_circle(stage: Stage) -> None:
    diameter = float(stage.junctions.diameter[0])
    assert _area_of(stage._lens(0, 0.0)) == pytest.approx(0.25 * pi * diameter**2, rel=0.01)
