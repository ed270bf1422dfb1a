"""What compare, verify, plot and psd answer in Python, of a run in a file and in memory."""

from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pytest
from scipy import signal

import rubnoise
from rubnoise.errors import RunFileRefused

mpl.use("agg")
SCENARIO = rubnoise.example("paper/fig5").replace({"sliding.distance": "4 mm"}, seed=5)


@pytest.fixture(scope="module")
def record() -> rubnoise.Record:
    return rubnoise.simulate(SCENARIO)


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
        assert saved.verify(regenerate=1).passed
    with pytest.raises(rubnoise.Refused, match=r"exists already \(force=True replaces it\)"):
        record.save(tmp_path / "saved.h5")
    record.save(tmp_path / "saved.h5", force=True).close()


def test_a_two_way_record_is_saved_whole(tmp_path: Path) -> None:
    scenario = rubnoise.example("paper/fig5_two_way").replace({"sliding.distance": "500 um"})
    with rubnoise.simulate(scenario).save(tmp_path / "x.h5") as saved:
        assert saved.verify(regenerate=1).passed


def test_an_intervention_is_kept_in_what_is_saved(tmp_path: Path) -> None:
    def end_one(env: Any, live: rubnoise.LiveJunctions) -> Any:
        yield env.timeout(50.0)
        live.end(next(iter(live)).number)

    record = rubnoise.simulate(SCENARIO.replace(distance="200 um"), intervene=end_one)
    with record.save(tmp_path / "x.h5") as saved:
        assert "end_one" in str(saved.provenance["intervention"])
        assert (saved.junctions["state"][:] & 4).any()


def test_a_right_run_passes_in_a_file_and_in_memory(record: rubnoise.Record, path: Path) -> None:
    with rubnoise.open(path) as run:
        for each in (record, run):
            answer = each.compare()
            assert answer.passed
            assert bool(answer)
            assert answer.outside == ()
            assert {row["figure"] for row in answer.rows} >= {"birth_count", "real_contact_area_mean"}
            assert len(answer.to_pandas()) == len(answer.rows)
            assert repr(answer).splitlines()[-1].startswith("passed: ")
            assert "<table>" in answer._repr_html_()
            found = each.verify()
            assert found.passed
            assert repr(found).splitlines()[-1].startswith("passed: ")


def test_a_run_of_another_contact_does_not_pass() -> None:
    wrong = rubnoise.simulate(SCENARIO)
    wrong["trace"]["real_contact_area"][:] *= 1.5
    answer = wrong.compare()
    assert not answer.passed
    assert not answer
    assert "real_contact_area_mean" in answer.outside
    assert repr(answer).splitlines()[-1].startswith("not passed: ")
    found = wrong.verify()
    assert not found.passed
    assert repr(found).splitlines()[-1].startswith("not passed: trace, areas")
    assert {row["check"] for row in found.rows if row["different"]} >= {"areas"}


def test_what_did_not_finish_or_knows_no_scenario_is_refused(record: rubnoise.Record) -> None:
    bare = rubnoise.Record(record.extent, groups=record.groups)
    for ask in (bare.compare, bare.verify, bare.psd, bare.plot):
        with pytest.raises(rubnoise.Refused, match="does not know its scenario"):
            ask()
    with pytest.raises(rubnoise.Refused, match="regenerate=-1"):
        record.verify(regenerate=-1)


@pytest.mark.parametrize(("quantity", "scale"), [("velocity", 1e-6), ("displacement", 1e-6), ("friction_force", 1e-6)])
def test_a_spectrum_in_time_is_that_of_scipy_in_si_units(record: rubnoise.Record, quantity: str, scale: float) -> None:
    seen, step = record.psd(quantity, segment=0.2), 1e-4
    values = scale * record.slider[quantity][:]
    frequency, density = signal.welch(values, fs=1.0 / step, nperseg=2000)
    np.testing.assert_allclose(seen.frequency, frequency, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(seen.density[1:-1], density[1:-1], rtol=1e-9, atol=1e-14 * density.max())
    assert seen.units == {"velocity": "(m/s)^2/Hz", "displacement": "m^2/Hz", "friction_force": "N^2/Hz"}[quantity]
    with pytest.raises(rubnoise.Refused, match=r"has \.frequency"):
        _ = seen.wavenumber


def test_the_exact_spectrum_beside_it_is_that_of_the_theory(record: rubnoise.Record) -> None:
    area = record.psd()
    assert (area.units, area.place_units) == ("um^4 per rad/um", "rad/um")
    np.testing.assert_array_equal(area.exact, rubnoise.exact(SCENARIO).spectral_density(area.wavenumber))
    assert record.psd("junction_count").exact is None
    # The mean over 40 bins of 64 half-overlapping segments: 1/sqrt(40 * 64 * 9/11) < 0.022, and 4 of them.
    seen = record.psd("velocity")
    assert seen.exact is not None
    near = slice(20, 60)
    assert np.mean(seen.density[near] / seen.exact[near]) == pytest.approx(1.0, abs=4 * 0.022)
    wrong = rubnoise.simulate(SCENARIO.replace({"strength.mean": "300 MPa"})).psd("velocity").density
    assert np.mean(wrong[near] / seen.exact[near]) > 1.0 + 4 * 0.022


def test_a_quantity_that_a_run_lacks_is_named(record: rubnoise.Record) -> None:
    with pytest.raises(KeyError, match="there are real_contact_area, junction_count, friction_force, displacement"):
        record.psd("speed")
    with pytest.raises(rubnoise.Refused, match="a segment of 2 rows"):
        record.psd("velocity", segment=3e-4)


@pytest.mark.parametrize("what", ["trace", "histogram", "slider"])
def test_a_picture_is_a_figure_that_a_notebook_shows(record: rubnoise.Record, what: str) -> None:
    figure: Any = record.plot(what, start=0.0, stop=2000.0)
    assert figure.axes
    assert figure._repr_png_()[:4] == b"\x89PNG"


def test_a_picture_takes_the_place_of_axes(record: rubnoise.Record) -> None:
    import matplotlib.pyplot as plt

    figure, (left, right) = plt.subplots(1, 2)
    record.plot("slider", left)
    assert left not in figure.axes
    assert right in figure.axes
    assert len(figure.subfigs) == 1
    assert len(figure.subfigs[0].axes) >= 2
    plt.close(figure)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ({"what": "force"}, "no picture of a run; there are trace, lives"),
        ({"what": "trace", "of": "velocity"}, 'is for "psd"'),
        ({"what": "psd", "of": "speed"}, 'is for "psd"'),
        ({"what": "trace", "beside": 1}, 'another run goes with "slider"'),
        ({"what": "trace", "start": 100.0, "stop": 50.0}, "nothing lies in 100 to 50 um"),
    ],
)
def test_a_picture_that_there_is_not_is_refused(record: rubnoise.Record, words: dict[str, Any], told: str) -> None:
    with pytest.raises(rubnoise.Refused, match=told):
        record.plot(**words)


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
    with pytest.raises(rubnoise.Refused, match=r"^where: error: no column diametre"):
        junctions.where("diametre > 5 um")


def test_what_is_shown_is_short(record: rubnoise.Record, path: Path) -> None:
    with rubnoise.open(path) as run:
        shown = (SCENARIO, run, record, run.junction(3), rubnoise.exact(SCENARIO), run.trace, run.junctions)
        assert all(len(repr(each)) <= 1500 for each in shown)
        assert all("<table>" in each._repr_html_() for each in shown)
    assert "&lt;b&gt;" in rubnoise.build({**SCENARIO.resolved(), "title": "<b>"})._repr_html_()


def test_a_file_with_values_that_no_run_has_is_refused_by_compare(path: Path, record: rubnoise.Record) -> None:
    wrong = rubnoise.simulate(SCENARIO)
    wrong["trace"]["real_contact_area"][7] = np.nan
    try:
        answer = wrong.compare()
    except RunFileRefused:
        return
    assert not answer.passed
