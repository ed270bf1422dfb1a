"""What compare, verify, plot, psd and exact answer in Python."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pint
import pytest
from numpy.typing import NDArray
from scipy import signal
from scipy.signal import welch

import rubnoise
from rubnoise.errors import RunFileRefused
from tests.laws.scores import seed_of

# What compare, verify, plot and psd answer in Python, of a run in a file and in memory.
mpl.use("agg")
SCENARIO = rubnoise.example("paper/fig5").replace({"sliding.distance": "4 mm"}, seed=5)


@pytest.fixture(scope="module")
def record() -> rubnoise.Record:
    return rubnoise.simulate(SCENARIO)


def with_area(record: rubnoise.Record, area: NDArray[Any]) -> rubnoise.Record:
    """Return the same run with another real contact area."""
    kept = record.reader().groups
    groups = kept | {"trace": kept["trace"] | {"real_contact_area": area}}
    return rubnoise.Record(replace(record.reader(), groups=groups))


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("answers") / "run.h5"
    rubnoise.run(SCENARIO, path).close()
    return path


def test_a_saved_record_is_the_run_that_run_writes(record: rubnoise.Record, path: Path, tmp_path: Path) -> None:
    with record.save(tmp_path / "saved.h5") as saved, rubnoise.open(path) as run:
        assert saved.groups().keys() == run.groups().keys()
        for name, columns in run.groups().items():
            assert all(saved.groups()[name][each][:].tobytes() == columns[each][:].tobytes() for each in columns)
        assert saved.scenario.resolved() == run.scenario.resolved()
        assert saved.verify().passed
    with pytest.raises(rubnoise.Refused, match=r"exists already \(force=True replaces it\)"):
        record.save(tmp_path / "saved.h5")
    record.save(tmp_path / "saved.h5", force=True).close()


@pytest.mark.slow
def test_a_right_run_passes_in_a_file_and_in_memory(record: rubnoise.Record, path: Path) -> None:
    with rubnoise.open(path) as run:
        for each in (record, run):
            answer = each.compare()
            assert answer.passed
            assert bool(answer)
            assert answer.outside == ()
            assert {row.name for row in answer.rows} >= {"birth_count", "real_contact_area_mean"}
            assert len(answer.to_pandas()) == len(answer.rows)
            assert "\npassed: " in repr(answer)
            assert "<table>" in answer._repr_html_()
            found = each.verify()
            assert found.passed
            assert "\npassed: " in repr(found)


@pytest.mark.slow
def test_a_run_of_another_contact_does_not_pass(record: rubnoise.Record) -> None:
    wrong = with_area(record, 1.5 * record.trace["real_contact_area"])
    answer = wrong.compare()
    assert not answer.passed
    assert not answer
    assert "real_contact_area_mean" in answer.outside
    assert "\nnot passed: " in repr(answer)
    found = wrong.verify()
    assert not found.passed
    assert "\nnot passed: trace (" in repr(found)
    assert found.failing == ("trace",)


@pytest.mark.parametrize(("quantity", "scale"), [("velocity", 1e-6), ("displacement", 1e-6), ("friction_force", 1e-6)])
def test_a_spectrum_in_time_is_that_of_scipy_in_si_units(record: rubnoise.Record, quantity: str, scale: float) -> None:
    seen, step = record.psd(quantity, segment=0.2), 1e-4
    values = scale * record.slider[quantity][:]
    frequency, density = signal.welch(values, fs=1.0 / step, nperseg=2000)
    np.testing.assert_allclose(seen.frequency, frequency, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(seen.density[1:-1], density[1:-1], rtol=1e-9, atol=1e-14 * density.max())
    units = {"velocity": "(m/s)^2/Hz", "displacement": "m^2/Hz", "friction_force": "N^2/Hz"}
    assert seen.density.units == units[quantity]
    with pytest.raises(AttributeError, match="it has frequency, density"):
        _ = seen.wavenumber


def test_the_exact_spectrum_beside_it_is_that_of_the_theory(record: rubnoise.Record) -> None:
    area = record.psd()
    assert (area.density.units, area.place.units) == ("um^4 per rad/um", "rad/um")
    np.testing.assert_array_equal(area.exact, rubnoise.exact(SCENARIO).spectral_density(area.wavenumber))
    assert record.psd("junction_count").exact is None
    # The mean over 40 bins of 64 half-overlapping segments: 1/sqrt(40 * 64 * 9/11) < 0.022, and 4 of them.
    seen = record.psd("velocity")
    assert seen.exact is not None
    near = slice(20, 60)
    assert np.mean(seen.density[near] / seen.exact[near]) == pytest.approx(1.0, abs=4 * 0.022)
    wrong = rubnoise.simulate(SCENARIO.replace({"strength.mean": "300 MPa"})).psd("velocity").density
    assert np.mean(wrong[near] / seen.exact[near]) > 1.0 + 4 * 0.022
    assert seen.plot("exact").axes[0].get_ylabel() == "exact ((m/s)^2/Hz)"


def test_a_segment_is_a_number_or_has_its_unit(record: rubnoise.Record) -> None:
    wanted = record.psd("velocity", segment=0.5).segments
    unit: Any = pint.UnitRegistry()
    for segment in ("0.5 s", "500 ms", 500 * unit.ms, np.float32(0.5)):
        assert record.psd("velocity", segment=segment).segments == wanted


@pytest.mark.parametrize("what", ["trace", "histogram", "slider"])
def test_a_picture_is_a_figure_that_a_notebook_shows(record: rubnoise.Record, what: str) -> None:
    figure: Any = record.plot(what, start=0.0, stop=2000.0)
    assert figure.axes
    assert figure._repr_png_()[:4] == b"\x89PNG"


def test_a_picture_takes_the_place_of_axes(record: rubnoise.Record) -> None:
    import matplotlib.pyplot as plt

    figure, (left, right) = plt.subplots(1, 2)
    assert record.plot("slider", left) is figure
    assert left not in figure.axes
    assert right in figure.axes
    assert len(figure.subfigs) == 1
    assert len(figure.subfigs[0].axes) >= 2
    with pytest.raises(rubnoise.Refused, match="ax: these axes left their figure"):
        record.plot("psd", left)
    with pytest.raises(rubnoise.Refused, match="the run has no load that weighs"):
        record.plot("load", right)
    assert right in figure.axes
    assert len(figure.subfigs) == 1
    plt.close(figure)


def test_rows_are_chosen_as_the_command_line_does(record: rubnoise.Record, path: Path) -> None:
    junctions = record.junctions
    chosen = junctions.where("diameter > 5.6 um and not alive_at_end")
    mask = (junctions["diameter"][:] > 5.6) & (junctions["state"][:] & 2 == 0)
    for name in junctions:
        np.testing.assert_array_equal(chosen[name], junctions[name][mask])
        np.testing.assert_array_equal(chosen[name][3:9:2], junctions[name][mask][3:9:2])
    assert len(chosen) == np.count_nonzero(mask) > 100
    assert len(junctions.where("diameter > 1 mm")) == 0
    with rubnoise.open(path) as run:
        np.testing.assert_array_equal(
            run.junctions.where("diameter > 5.6 um")["diameter"][:], junctions.where("diameter > 5.6")["diameter"]
        )


def test_chosen_rows_keep_their_numbers(path: Path) -> None:
    with rubnoise.open(path) as run:
        columns = run.junctions
        scale, other = columns.names[0], "diameter"
        chosen = columns.where(f"{scale} > 2 and {scale} < 7")
        labelled = chosen.to_xarray()
        assert labelled.indexes[scale].tolist() == chosen.to_pandas().index.tolist() == [3, 4, 5, 6]
        assert labelled[other].sel({scale: 5}).item() == columns[other][5]
        assert chosen.where(f"{scale} != 4").to_xarray()[scale].values.tolist() == [3, 5, 6]


def test_a_file_with_values_that_no_run_has_is_refused_by_compare(path: Path, record: rubnoise.Record) -> None:
    area = record.trace["real_contact_area"][:]
    area[7] = np.nan
    wrong = with_area(record, area)
    try:
        answer = wrong.compare()
    except RunFileRefused:
        return
    assert not answer.passed


# What an `Exact` says of empty starts and of estimated spectra, beside runs that are made through the public door.
Doubles = NDArray[np.float64]

RUNS = 300
BOUND = 4.0
PLACES = np.array([2.0, 5.0, 9.0])


def contact(**sliding: object) -> rubnoise.Scenario:
    return rubnoise.build(
        {
            "interface": {"mean_real_contact_area": 200.0, "mean_junction_count": 20},
            "diameter": {"law": "normal", "spread": "20 %"},
            "sliding": {"distance": 10.0} | sliding,
            "output": {"tick": 0.25},
            "run": {"engine": "batch"},
        }
    )


@pytest.fixture(scope="module")
def empty() -> tuple[Doubles, Doubles]:
    """Return the area and the count of many runs that begin empty, a row a run."""
    scenario, seed = contact(start="empty"), seed_of("empty starts") % 2**50
    traces = [rubnoise.simulate(scenario, seed + n).trace for n in range(RUNS)]
    area, count = (np.stack([trace[name] for trace in traces]) for name in ("real_contact_area", "junction_count"))
    return area, count.astype(np.float64)


def scores(values: Doubles, expected: Doubles | float) -> Doubles:
    error = values.std(axis=0, ddof=1) / np.sqrt(values.shape[0])
    return np.asarray((values.mean(axis=0) - expected) / error)


def test_means_after_an_empty_start(empty: tuple[Doubles, Doubles]) -> None:
    theory, at = rubnoise.exact(contact(start="empty")), (PLACES / 0.25).astype(int)
    for values, grown, settled in (
        (empty[0], theory.area_from_empty(PLACES), theory.area.mean),
        (empty[1], theory.count_from_empty(PLACES), theory.count_mean),
    ):
        assert np.max(np.abs(scores(values[:, at], grown))) <= BOUND
        assert np.max(np.abs(scores(values[:, at], settled))) > 4.0 * BOUND


def test_the_mean_of_a_run_that_begins_empty(empty: tuple[Doubles, Doubles]) -> None:
    theory = rubnoise.exact(contact(start="empty"))
    area, count = (np.trapezoid(values, dx=0.25, axis=1) / 10.0 for values in empty)
    assert abs(scores(area, theory.expected_mean_area())) <= BOUND
    assert abs(scores(area, theory.area.mean)) > 4.0 * BOUND
    # The count steps at births and deaths: half a tick of growth is what the trapezoid may miss at the ends.
    assert abs(scores(count, theory.expected_mean_count())) <= BOUND
    assert theory.expected_mean_area(20.0) > theory.expected_mean_area()
    stationary = rubnoise.exact(contact())
    assert stationary.expected_mean_area() == pytest.approx(stationary.area.mean, rel=1e-14)
    assert stationary.expected_mean_count(3.0) == stationary.count_mean


TICKS = 64
LONG = contact(distance="10 mm", start="stationary")


@pytest.fixture(scope="module")
def estimate() -> tuple[Doubles, Doubles]:
    """Return scipy's estimate from one run, at wavenumbers in rad/um and two-sided."""
    area = rubnoise.simulate(LONG, seed_of("an estimated spectrum") % 2**50).trace["real_contact_area"][:]
    cycles, density = welch(area, fs=4.0, window="hann", nperseg=TICKS, detrend="constant")
    return 2.0 * np.pi * cycles, 0.5 * density


def test_an_estimate_is_as_expected_in_every_bin(estimate: tuple[Doubles, Doubles]) -> None:
    theory = rubnoise.exact(LONG)
    seen = theory.estimated_spectrum(TICKS)
    inner = slice(1, TICKS // 2)  # at the ends of the axis a one-sided density is not twice the two-sided one
    np.testing.assert_allclose(seen.wavenumber, estimate[0], rtol=1e-12)
    z = (estimate[1] - seen.density) / seen.standard_error
    assert seen.segments == (40_001 - TICKS) // 32 + 1
    assert np.max(np.abs(z[inner])) <= BOUND
    plain = (estimate[1] - theory.spectral_density(seen.wavenumber)) / seen.standard_error
    assert np.max(np.abs(plain[inner])) > 4.0 * BOUND
