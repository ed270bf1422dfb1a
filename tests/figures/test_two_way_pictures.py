"""Pictures of a slider's motion show what its rows hold: sticks, paths, lengths, spectra, and one run over another."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib.image
import numpy as np
import pytest
from paper.figures import Sources
from paper.traces import draw_fig5
from scipy.signal import welch

import rubnoise
from rubnoise.errors import Refused
from rubnoise.figure_names import FIGURE_NAMES, TWO_WAY
from rubnoise.figures import motion as motions
from rubnoise.figures import slider as phases
from rubnoise.figures.axis_labels import quantity_label
from rubnoise.figures.catalogue import picture
from rubnoise.figures.motion import STICKS, Motion, spans
from rubnoise.figures.motion_spectrum import motion_spectrum_figure
from rubnoise.figures.slider import landmarks_figure, phase_figure, slider_figure, time_shares
from rubnoise.figures.stretch import MOST_POINTS, Stretch
from rubnoise.figures.study import study_of_sweep
from rubnoise.figures.study_picture import draw_study
from rubnoise.figures.style import house_style
from rubnoise.record.rows import LandmarkKind, Phase
from rubnoise.storage.reader import open_run
from rubnoise.theory.motion import response
from tests.architecture.sources import ROOT
from tests.figures.papers import band_of

FIG5 = ROOT / "scenarios" / "paper" / "fig5.toml"
Doubles = np.ndarray


def _opened(folder: Path, name: str, *changes: str) -> Iterator[Stretch]:
    path = folder / f"{name}.h5"
    scenario = rubnoise.load(FIG5, ['sliding.distance="2.5 mm"', "run.engine=batch", *changes])
    rubnoise.run(scenario, path).close()
    with open_run(path) as file:
        yield Stretch.of(file)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("motion")


@pytest.fixture(scope="module")
def two_way(folder: Path) -> Iterator[Stretch]:
    yield from _opened(folder, "two", "slider.coupling=two-way")


@pytest.fixture(scope="module")
def one_way(folder: Path) -> Iterator[Stretch]:
    yield from _opened(folder, "one")


@pytest.fixture(scope="module")
def fast(folder: Path) -> Iterator[Stretch]:
    """Return a two-way run that is too fast to stick."""
    yield from _opened(folder, "fast", "slider.coupling=two-way", 'sliding.speed="100 mm/s"')


@pytest.fixture(scope="module")
def force_alone(folder: Path) -> Iterator[Stretch]:
    """Return a run without a slider, whose force is in /trace."""
    scenario = rubnoise.load(FIG5, ['sliding.distance="2.5 mm"', 'output.tick="0.1 um"', "run.engine=batch"])
    rubnoise.run(scenario.replace(slider=None), folder / "force.h5").close()
    with open_run(folder / "force.h5") as file:
        yield Stretch.of(file)


@dataclass(frozen=True, kw_only=True)
class Held:
    """Rows of a made-up slider."""

    groups: dict[str, dict[str, Any]]
    path: Path = field(default=Path("held.h5"))

    @property
    def columns(self) -> dict[str, tuple[str, ...]]:
        return {group: tuple(columns) for group, columns in self.groups.items()}

    def rows(self, group: str) -> int:
        return len(next(iter(self.groups[group].values())))

    def column(self, group: str, name: str, start: int = 0, stop: int | None = None) -> np.ndarray:
        return np.asarray(self.groups[group][name])[start:stop]


def _column(stretch: Stretch, name: str) -> np.ndarray:
    return stretch.file.column("slider", name)


def _line(axes: Any, label: str) -> tuple[np.ndarray, np.ndarray]:
    (found,) = (line for line in axes.lines if str(line.get_label()).startswith(label))
    return found.get_data()


def _shaded(axes: Any) -> list[tuple[float, float]]:
    """Return where sticks are shaded, in s."""
    found = [each for each in axes.collections if each.get_label() == "stick"]
    corners = [path.vertices[:, 0] for each in found for path in each.get_paths()]
    return [(float(x.min()), float(x.max())) for x in corners]


# Motions and their stretches


def test_many_sticks_are_shaded_by_their_share(monkeypatch: pytest.MonkeyPatch) -> None:
    begin = np.sort(np.random.default_rng(3).uniform(0.0, 9.0, 700))
    end = begin + 0.4 * np.diff(np.append(begin, 10.0))
    assert spans(begin, end, 0.0, 10.0)[1].tolist() == (end - begin).tolist()
    monkeypatch.setattr(motions, "MOST_SPANS", 50)
    place, width, share = spans(begin, end, 0.0, 10.0)
    assert place.size == 50
    assert float(width @ share) == pytest.approx(float((end - begin).sum()), rel=1e-12)
    fine = np.linspace(2.0, 2.2, 4001)
    stuck = np.any((fine[:, None] >= begin) & (fine[:, None] < end), axis=1)
    assert share[10] == pytest.approx(float(np.mean(stuck)), abs=5e-3)


def test_a_stretch_is_passed_for_the_first_time(two_way: Stretch) -> None:
    distance = _column(two_way, "distance")
    first, last = Stretch.of(two_way.file, 400.0, 900.0).rows("slider")
    assert distance[first - 1] < 400.0 <= distance[first]
    assert distance[last - 1] <= 900.0 < distance[last]
    assert two_way.rows("slider") == (0, distance.size)
    assert two_way.rows("trace") != two_way.rows("slider")
    beyond = Stretch.of(two_way.file, 2000.0, 9999.0).rows("slider")
    assert beyond == (int(np.flatnonzero(distance >= 2000.0)[0]), distance.size)


def test_running_back_does_not_end_a_stretch(two_way: Stretch, monkeypatch: pytest.MonkeyPatch) -> None:
    distance = [0.0, 3.0, 6.0, 4.0, 2.0, 5.0, 7.0, 6.0, 9.0, 12.0]
    made_up = Stretch(
        file=Held(groups={"slider": {"distance": distance}}),  # type: ignore[arg-type]
        model=two_way.model,
        title="",
        start=5.0,
        stop=8.0,
        chosen=True,
    )
    for chunk_rows in (2, 3, 4, 100):
        monkeypatch.setattr("rubnoise.arrays.CHUNK_ROWS", chunk_rows)
        assert made_up.rows("slider") == (2, 8)


def test_too_short_a_stretch_is_refused(two_way: Stretch) -> None:
    distance = _column(two_way, "distance")
    fastest = int(np.argmax(np.diff(distance)))
    inside = distance[fastest] + np.array([0.1, 0.4]) * (distance[fastest + 1] - distance[fastest])
    assert inside[1] - inside[0] > 0.2  # some ticks of /trace
    with pytest.raises(
        Refused, match=r"the slider passes .* um in less than the 0\.0001 s between two rows of /slider"
    ):
        Motion.of(Stretch.of(two_way.file, *inside.tolist()))


def test_the_beginning_holds_sticks_enough(two_way: Stretch, fast: Stretch) -> None:
    shown = Motion.of(two_way).beginning()
    found = shown.stick_slip()
    assert shown.first == 0
    assert STICKS <= found.stick_begin.size <= STICKS + 1
    assert Motion.of(fast).beginning() == Motion.of(fast)  # 25 ms: not one period
    with pytest.raises(Refused, match="the run is over before 5 s"):
        Motion.of(fast).between(5.0, 6.0)


# Pictures


def test_the_slider_is_drawn_as_it_moves_and_shaded_where_it_sticks(two_way: Stretch) -> None:
    with house_style():
        force, place, spectrum = slider_figure(two_way).axes
    time, shown = _line(place, "simulated")
    rows = np.round(time / 1e-4).astype(int)
    extremes = _column(two_way, "displacement")
    assert shown.max() == extremes[: rows[-1] + 9].max()
    assert shown.min() == extremes[: rows[-1] + 9].min()
    assert _line(force, "simulated")[1].max() == 1e-3 * _column(two_way, "friction_force")[: rows[-1] + 9].max()
    shaded = _shaded(place)
    assert shaded == _shaded(force)
    assert len(shaded) > 10
    at = np.arange(rows[-1]) * 1e-4
    stuck = np.any([(at > begin) & (at < end) for begin, end in shaded], axis=0)
    assert np.array_equal(stuck, _column(two_way, "phase")[: at.size] == Phase.STICK)
    labels = [str(line.get_label()) for line in spectrum.lines]
    assert "exact, one-way" in labels
    assert not any("mean" in str(each.get_label()) for axes in (force, place) for each in axes.patches)


def test_a_chosen_stretch_is_drawn_row_by_row(two_way: Stretch) -> None:
    chosen = Stretch.of(two_way.file, 300.0, 420.0)
    first, last = chosen.rows("slider")
    with house_style():
        place = slider_figure(chosen).axes[1]
    time, shown = _line(place, "simulated")
    assert np.array_equal(shown, _column(two_way, "displacement")[first:last])
    np.testing.assert_allclose(time, _column(two_way, "time")[first:last], rtol=1e-14)


def test_a_long_run_is_thinned(two_way: Stretch) -> None:
    with house_style():
        time, shown = _line(slider_figure(Stretch.of(two_way.file, 0.0, 2500.0)).axes[1], "simulated")
    whole = _column(two_way, "displacement")
    assert whole.size > 4 * MOST_POINTS
    assert time.size <= MOST_POINTS + 2
    assert (shown.min(), shown.max()) == (whole.min(), whole.max())


def test_a_slider_that_never_sticks_is_not_shaded(fast: Stretch) -> None:
    with house_style():
        for figure in (slider_figure(fast), phase_figure(fast)):
            assert [_shaded(axes) for axes in figure.axes] == [[]] * len(figure.axes)
    with pytest.raises(Refused, match="the slider ends no slip and no stick between 0 and"):
        picture("landmarks", fast, "png")


def test_one_way_motion_has_its_exact_band_and_no_sticks(one_way: Stretch) -> None:
    with house_style():
        place = slider_figure(one_way).axes[1]
        path, *_ = phase_figure(one_way).axes
    assert _shaded(place) == []
    exact = response(one_way.model)
    assert any(np.allclose(line.get_ydata(), exact.mean_displacement) for line in place.lines)
    x, v = _line(path, "exact standard deviations")
    assert np.ptp(x) == pytest.approx(2.0 * exact.displacement_std, rel=1e-3)
    assert np.ptp(v) == pytest.approx(2e-3 * exact.velocity_std, rel=1e-3)


def test_a_stick_is_a_line_at_the_speed_of_the_drive(two_way: Stretch) -> None:
    chosen = Stretch.of(two_way.file, 100.0, 900.0)
    first, last = chosen.rows("slider")
    with house_style():
        (axes,) = phase_figure(chosen).axes
    place, speed = _line(axes, "simulated")
    assert np.array_equal(place, _column(two_way, "displacement")[first:last])
    stuck = _column(two_way, "phase")[first:last] == Phase.STICK
    assert stuck.sum() > 100
    assert np.all(speed[stuck] == 1.0)
    assert np.all(speed[~stuck] < 1.0)
    assert np.all(np.equal(_line(axes, "speed V of the drive, 1 mm/s")[1], 1.0))
    assert axes.get_ylim()[1] > 1.0 + 0.05 * np.ptp(speed)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("displacement (µm)", "velocity (mm/s)")


def test_the_plane_is_as_dark_as_the_slider_is_often_there(two_way: Stretch, monkeypatch: pytest.MonkeyPatch) -> None:
    motion = Motion.of(two_way)
    share, (place, speed) = time_shares(motion)
    assert share.sum() == pytest.approx(1.0)
    x, v = _column(two_way, "displacement"), _column(two_way, "velocity")
    i, j = np.unravel_index(np.argmax(share), share.shape)
    inside = (x >= place[i]) & (x < place[i + 1]) & (v >= speed[j]) & (v < speed[j + 1])
    assert share[i, j] == np.mean(inside)
    riding = int(np.searchsorted(speed, 1000.0)) - 1
    assert share[:, riding].sum() >= np.mean(_column(two_way, "phase") == Phase.STICK)
    with house_style():
        panes = phase_figure(two_way).axes
        assert [str(each.get_title(loc="left"))[:9] for each in panes[:2]] == ["the path,", "how often"]
        monkeypatch.setattr(phases, "MOST_ON_A_PATH", 1000)
        (pane, _bar) = phase_figure(Stretch.of(two_way.file, 0.0, 2500.0)).axes
    assert not any(line.get_label() == "simulated" for line in pane.lines)
    drawn = next(each for each in pane.collections if each.get_array() is not None)
    assert float(np.ma.sum(drawn.get_array())) == pytest.approx(1.0)


def test_slips_and_sticks_are_counted_by_length(two_way: Stretch) -> None:
    kind, time, distance = (two_way.file.column("landmarks", name) for name in ("kind", "time", "distance"))
    lengths, times = [], []
    for one in range(kind.size - 1):
        if kind[one] == LandmarkKind.STICK:
            times.append(time[one + 1] - time[one])
        elif kind[one] == LandmarkKind.SLIP:
            lengths.append(distance[one + 1] - distance[one])
    with house_style():
        slips, sticks = landmarks_figure(two_way).axes
    for axes, values, scale, unit in ((slips, lengths, 1.0, "µm"), (sticks, times, 1e3, "ms")):
        bars = {(bar.get_x(), bar.get_x() + bar.get_width()): bar.get_height() for bar in axes.patches}
        scaled = scale * np.array(values)
        assert sum(bars.values()) == len(values) > 20
        for (low, high), height in bars.items():
            assert height == np.sum((scaled >= low * (1 + 1e-12)) & (scaled < high * (1 + 1e-12)))
        assert _line(axes, "median")[0][0] == pytest.approx(np.median(scaled))
        assert axes.get_xlabel().endswith(f"({unit})")
        assert axes.get_legend_handles_labels()[1][0] == f"{len(values)} {'slips' if unit == 'µm' else 'sticks'}"
    mean = two_way.model.calibrated_diameter
    longer = sum(length > mean for length in lengths)
    assert _line(slips, f"mean diameter; {longer} slips are longer")[0][0] == mean
    duration = float(two_way.file.column("balance", "time")[0])
    assert longer == round(float(two_way.file.summary["slips_longer_than_d_per_s"]) * duration) > 5


def test_landmarks_are_of_two_way_sliders_alone(one_way: Stretch) -> None:
    with pytest.raises(Refused, match=r'only with slider\.coupling = "two-way" does it stick and slip'):
        picture("landmarks", one_way, "png")


@pytest.mark.parametrize(
    ("heard", "column", "scale"),
    [("velocity", "velocity", 1e-3), ("displacement", "displacement", 1.0), ("force", "friction_force", 1e-3)],
)
def test_spectra_over_frequency_are_those_of_scipy(
    one_way: Stretch, two_way: Stretch, heard: Any, column: str, scale: float
) -> None:
    for stretch, label in ((one_way, "exact"), (two_way, "exact, one-way")):
        with house_style():
            axes = motion_spectrum_figure(stretch, heard).axes[0]
        frequency, density = _line(axes, "simulated")
        count = round(2.0 / (frequency[0] * 1e-4))
        values = scale * _column(stretch, column)
        hertz, expected = welch(values, 1e4, "hann", count, count // 2, detrend="constant")
        np.testing.assert_allclose(frequency, hertz[2 : frequency.size + 2], rtol=1e-9)
        np.testing.assert_allclose(density, expected[2 : frequency.size + 2], rtol=1e-6)
        _, exact = _line(axes, label)
        assert exact.max() > 0.0
        assert axes.figure.axes[-1].get_xlabel() == "frequency (Hz)"
        assert "/Hz)" in axes.get_ylabel()


def test_a_run_without_a_slider_has_the_spectrum_of_its_force(force_alone: Stretch, one_way: Stretch) -> None:
    with house_style():
        above, _ = motion_spectrum_figure(force_alone, "force").axes
    frequency, density = _line(above, "simulated")
    count = round(2.0 / (frequency[0] * 1e-4))
    values = 1e-3 * force_alone.file.column("trace", "friction_force")
    _, expected = welch(values, 1e4, "hann", count, count // 2, detrend="constant")
    np.testing.assert_allclose(density, expected[2 : frequency.size + 2], rtol=1e-6)
    labels = {str(line.get_label()) for line in above.lines}
    assert "one per mean life" in labels
    assert not any("Kilburn" in label or "natural" in label for label in labels)
    for name in ("psd", "histogram"):
        assert picture(name, force_alone, "png", heard="force")
        with pytest.raises(Refused, match="no slider to draw"):
            picture(name, force_alone, "png", heard="velocity")
    # Beside the force of a run with a slider, each is called by its file.
    with house_style():
        above = motion_spectrum_figure(force_alone, "force", one_way).axes[0]
    assert {"force.h5", "one.h5"} <= {str(line.get_label()) for line in above.lines}


@pytest.mark.parametrize(
    ("run", "heard"),
    [("one_way", "velocity"), ("one_way", "displacement"), ("one_way", "force"), ("force_alone", "force")],
)
def test_a_one_way_spectrum_is_what_is_expected_of_it(run: str, heard: Any, request: pytest.FixtureRequest) -> None:
    with house_style():
        figure = motion_spectrum_figure(request.getfixturevalue(run), heard)
    _, below = figure.axes
    frequency, ratio = _line(below, "simulated over expected")
    error = 0.5 * np.array([band_of(below)[float(each)] for each in frequency])
    weight = error**-2 / np.sum(error**-2)
    known, of_mean = float(np.sum(weight * ratio)), float(np.sqrt(np.sum((weight * error) ** 2)))
    assert known == pytest.approx(1.0, abs=4.0 * of_mean)
    assert 0.8 * known != pytest.approx(1.0, abs=4.0 * of_mean), "a spectrum a fifth too low is noticed"


def test_no_ratio_is_drawn_of_what_theory_does_not_know(two_way: Stretch) -> None:
    with house_style():
        assert len(motion_spectrum_figure(two_way, "velocity").axes) == 1


def test_the_exact_spectrum_of_the_velocity_adds_up_to_its_variance(one_way: Stretch) -> None:
    with house_style():
        axes = motion_spectrum_figure(one_way, "velocity").axes[0]
    frequency, exact = _line(axes, "exact")
    variance = (1e-3 * response(one_way.model).velocity_std) ** 2
    assert np.trapezoid(exact, frequency) == pytest.approx(variance, rel=0.02)


def test_too_short_a_stretch_has_no_spectrum(two_way: Stretch) -> None:
    with pytest.raises(Refused, match=r"a spectrum needs 0\.0104 s of a velocity that varies"):
        motion_spectrum_figure(Stretch.of(two_way.file, 0.0, 1.0), "velocity")


def test_one_run_is_laid_over_another_at_the_same_times(one_way: Stretch, two_way: Stretch) -> None:
    with house_style():
        force, place, spectrum = slider_figure(one_way, two_way).axes
        (plane,) = phase_figure(one_way, two_way).axes
        heard, _ = motion_spectrum_figure(one_way, "velocity", two_way).axes
        title = str(slider_figure(one_way, two_way).get_suptitle())
    assert title.endswith("\none.h5, and over it two.h5")
    end = place.get_xlim()[1]
    for stretch, label in ((one_way, "one-way coupling"), (two_way, "two-way coupling")):
        time, shown = _line(place, label)
        values = _column(stretch, "displacement")[: round(end / 1e-4) + 1]
        assert (shown.min(), shown.max()) == (values.min(), values.max())
        assert time.max() <= end
        assert np.array_equal(_line(plane, label)[0], values)
    assert _shaded(force) == _shaded(place) != []
    labels = {str(line.get_label()) for line in spectrum.lines}
    assert {"one-way coupling", "two-way coupling", "exact"} <= labels
    assert {str(line.get_label()) for line in heard.lines} == labels


@pytest.mark.parametrize("name", ["slider", "phase", "landmarks"])
def test_they_are_drawn_to_files_and_cut_nothing_off(two_way: Stretch, name: str) -> None:
    pixels = np.asarray(matplotlib.image.imread(BytesIO(picture(name, two_way, "png"))))[:, :, :3]
    border = np.concatenate([pixels[:2].reshape(-1, 3), pixels[-2:].reshape(-1, 3), pixels[:, :2].reshape(-1, 3)])
    assert np.all(border == 1.0)
    assert np.ptp(pixels) == 1.0
    assert picture(name, two_way, "svg").startswith(b"<?xml")


# Figure 5


def test_figure_5_of_a_two_way_slider_has_no_one_way_band(folder: Path) -> None:
    lines = ["format = 1", f'extends = "{FIG5}"', '[sliding]\ndistance = "1.2 mm"', '[slider]\ncoupling = "two-way"']
    (folder / "fig5.toml").write_text("\n".join(lines), encoding="utf-8")
    with house_style():
        figure = draw_fig5(Sources(folder=folder))
    for axes in figure.axes:
        assert [each.get_label() for each in axes.collections] == ["stick"]
        assert not any(str(each.get_label()).startswith("exact") for each in [*axes.patches, *axes.lines])


# Sweeps


@pytest.fixture(scope="module")
def swept(folder: Path) -> Iterator[rubnoise.SweepResult]:
    (folder / "s.toml").write_text(
        f'format = 1\nextends = "{FIG5}"\n[output]\ntick = "1 um"\n[run]\nengine = "batch"\n'
        '[sliding]\ndistance = "0.6 mm"\n[sweep]\nkeep = "summary"\nreplicates = 2\n[sweep.grid]\n'
        'slider.coupling = ["one-way", "two-way"]\nsliding.speed = ["1 mm/s", "10 mm/s"]\n',
        encoding="utf-8",
    )
    with rubnoise.sweep(folder / "s.toml", folder / "s", jobs=1) as found:
        yield found


@pytest.mark.parametrize(
    ("quantity", "legend", "label"),
    [
        ("displacement_std", ["one-way", "two-way", "exact"], "displacement (µm)"),
        ("stick_fraction", ["two-way"], "share of the time in which the slider sticks"),
        ("sticks_per_s", ["two-way"], "sticks of the slider in a second (1/s)"),
        ("one_way_validity", ["one-way", "exact"], "velocity over sliding speed"),
    ],
)
def test_a_sweep_shows_only_what_a_coupling_has(
    swept: rubnoise.SweepResult, quantity: str, legend: list[str], label: str
) -> None:
    study = study_of_sweep(swept, quantity)
    with house_style():
        (axes,) = draw_study(study).axes
    shown = axes.get_legend()
    assert [text.get_text() for text in shown.get_texts()] == legend
    assert axes.get_ylabel().replace("\n", " ").endswith(label)
    values = swept.runs[quantity][:]
    drawn = {place: y for line in axes.containers for place, y in zip(*line[0].get_data(), strict=True)}
    two_way = values[
        np.array([value["slider.coupling"] == "two-way" for value in swept.values])[swept.runs["point"][:]]
    ]
    if legend == ["two-way"]:
        assert sorted(drawn) == [1.0, 10.0]
        assert axes.get_xlabel() == "sliding speed (mm/s)"
        assert list(drawn.values()) == pytest.approx([two_way[:2].mean(), two_way[2:].mean()])


def test_every_figure_of_a_two_way_run_has_a_name_in_pictures(two_way: Stretch) -> None:
    assert {name for name in two_way.file.summary if "_exact" not in name and "_standard" not in name} <= set(
        FIGURE_NAMES
    )
    assert set(TWO_WAY) <= set(two_way.file.summary)
    assert all(quantity_label(name) for name in FIGURE_NAMES)
