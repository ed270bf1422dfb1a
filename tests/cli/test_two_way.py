"""A scenario whose slider pushes back, from `check` to `verify`: run, opened and looked at."""

import json
import wave
from pathlib import Path

import h5py
import numpy as np
import pytest
import xarray

import rubnoise
from rubnoise.errors import Refused
from tests.cli.terminal import call, columns
from tests.cli.test_signals import SHORT, SLIDER

TWO_WAY = ("--set", "slider.coupling=two-way", *SHORT)
MOTION = ("displacement_std", "stick_fraction", "sticks_per_s", "reversals_per_s", "slips_longer_than_d_per_s")


@pytest.fixture
def ran(here: Path) -> Path:
    """Return the file of a two-way run."""
    done = call("run", SLIDER, "-o", "x.h5", *TWO_WAY)
    assert (done.code, done.err) == (0, "")
    return here / "x.h5"


def test_a_run_tells_what_it_measured_and_its_laws_but_no_exact_motion_beside_it(ran: Path) -> None:
    done = call("run", SLIDER, "-o", "y.h5", "--json", *TWO_WAY)
    assert done.code == 0
    summary = json.loads(done.out)["summary"]
    assert all(not {"exact", "z"} & set(summary[name]) for name in MOTION)
    assert summary["real_contact_area_mean"]["exact"] > 0.0
    assert "one_way_validity" not in summary
    with h5py.File(ran) as file:
        assert "displacement_std_exact" not in file["summary"].attrs
        phase, kind, rows = file["slider/phase"][:], file["landmarks/kind"][:], file["slider/time"].size
        balance = {name: column[0] for name, column in file["balance"].items()}
        where, displacement = file["landmarks/distance"][:], file["slider/displacement"][:]
        assert {column.size for column in file["balance"].values()} == {1}
        time, tick = balance["time"], file["slider/time"][1]
        assert 0.0 <= time - (rows - 1) * tick < tick
        seen = {name: figure["value"] for name, figure in summary.items()}
        assert seen["stick_fraction"] == pytest.approx(np.mean(phase == 1), abs=0.01)
        assert seen["stick_fraction"] == balance["time_stuck"] / time
        assert seen["sticks_per_s"] == pytest.approx((kind == 0).sum() / time, rel=1e-12)
        assert seen["reversals_per_s"] == pytest.approx((kind == 2).sum() / time, rel=1e-12)
        assert not (kind > 1).any()
        slips = np.diff(where)[kind[:-1] == 1]
        diameter = file["provenance"].attrs["calibrated_diameter"]
        assert 0 < (slips > diameter).sum() < slips.size
        assert seen["slips_longer_than_d_per_s"] == pytest.approx((slips > diameter).sum() / time, rel=1e-12)
        assert seen["displacement_mean"] == pytest.approx(displacement.mean(), rel=1e-3)
        assert seen["displacement_std"] == pytest.approx(displacement.std(), rel=1e-2)
        excess = summary["mean_force_excess"]
        assert excess["value"] == pytest.approx(excess["exact"], rel=1e-9)
        assert abs(excess["exact"]) > 10.0
        assert summary["energy_residual"]["exact"] == 0.0
        assert abs(seen["energy_residual"]) < 1e-10
        assert file["slider/phase"].attrs["flag_meanings"] == b"slip stick reversal"
        assert file["landmarks/kind"].attrs["flag_values"].tolist() == [0, 1, 2, 3]
    assert 0.3 < summary["stick_fraction"]["value"] < 1.0


def test_a_run_of_one_row_has_a_time_and_rates_all_the_same(here: Path) -> None:
    """A slider that is thrown back at once comes to the end of a tick of distance before a tick of time has passed."""
    short = ["--set", "sliding.distance=0.05 um", "--set", "output.tick=0.05 um", "--set", "slider.coupling=two-way"]
    assert call("run", SLIDER, "-o", "one.h5", "-q", "--seed", "1", *short).code == 0
    with h5py.File("one.h5") as file:
        assert file["slider/time"].size == 1
        assert file["summary"].attrs["stick_fraction"] == 0.0
        assert 0.0 < file["balance/time"][0] < 5e-5
        rates = [value for name, value in file["summary"].attrs.items() if name.endswith("_per_s")]
        assert rates == [0.0, 0.0, 0.0]
        assert abs(file["summary"].attrs["energy_residual"]) < 1e-9
    assert call("verify", "one.h5").code == 0


def test_engines_give_equal_bits_and_the_contact_of_one_way(ran: Path) -> None:
    assert call("run", SLIDER, "-o", "batch.h5", "-q", "--engine", "batch", *TWO_WAY).code == 0
    assert call("run", SLIDER, "-o", "one.h5", "-q", *SHORT).code == 0
    here, batch, one_way = (columns(ran.with_name(name)) for name in ("x.h5", "batch.h5", "one.h5"))
    assert here == batch
    own = {"junctions/birth_time", "junctions/death_time"}
    shared = [name for name in here if name.lstrip("/").split("/")[0] in {"junctions", "trace", "life_curve"}]
    assert len(shared) > 10
    assert {name.lstrip("/") for name in shared if here[name] != one_way[name]} == own


def test_info_and_check_name_what_is_there(ran: Path) -> None:
    told = json.loads(call("info", ran, "--json").out)
    assert "landmarks" in json.dumps(told)
    shown = call("info", ran).out
    assert "  landmarks  " in shown
    assert "the slider pushes back" in " ".join(shown.split())
    checked = call("check", SLIDER, *TWO_WAY)
    assert checked.code == 0
    assert "the slider pushes back" in " ".join(checked.out.split())
    assert "slider rows at most" in checked.out
    (answer,) = call("check", SLIDER, *TWO_WAY, "--json").values()["scenarios"].values()
    with h5py.File(ran) as file:
        assert file["slider/time"].size <= answer["cost"]["slider_rows_at_most"] < 2 * file["slider/time"].size
    assert "slider_rows_at_most" not in call("check", SLIDER, *SHORT, "--json").out
    assert "warning" not in checked.out + checked.err


def test_verify_holds_what_it_can_and_names_what_it_leaves_out(ran: Path) -> None:
    done = call("verify", ran, "--json")
    assert done.code == 0
    told = json.loads(done.out)
    assert set(told.get("left_out", {})) <= {"scenario"}


@pytest.mark.parametrize(
    ("place", "change"),
    [
        ("slider/time", 1e-9),
        ("slider/distance", 1e-3),
        ("slider/displacement", 1e-3),
        ("slider/phase", 1),
        ("landmarks/kind", 1),
        ("landmarks/time", 1.0),
        ("landmarks/velocity", 1e-9),
        ("landmarks/landmark", 1),
        ("junctions/birth_time", -1.0),
        ("junctions/death_time", np.nan),
        ("balance/time", 1e-6),
        ("balance/displacement_integral", 1e-6),
        ("balance/friction_work", 1.0),
        ("balance/time_stuck", 1e-9),
    ],
)
def test_a_changed_row_is_named(ran: Path, place: str, change: float) -> None:
    with h5py.File(ran, "r+") as file:
        row = int(np.flatnonzero(file["slider/phase"][:] == 1)[40]) if place.startswith("slider") else 20
        row += 60 * place.startswith("junctions")
        row = 0 if place.startswith("balance") else row
        file[place][row] = file[place][row] + change
    done = call("verify", ran, "--json")
    assert done.code == 3
    found = json.loads(done.out)["checks"][place.partition("/")[0]]
    assert found["note"].startswith(f"1 different; the first: /{place} row {row} is ")


@pytest.mark.parametrize("tolerance", ["1e-4", "1e-12"])
@pytest.mark.parametrize("count", ["1", "20"])
def test_a_right_run_keeps_all_of_it(here: Path, count: str, tolerance: str) -> None:
    changes = (f"interface.mean_junction_count={count}", f"slider.tolerance={tolerance}", "interface.calibration=exact")
    words = [word for change in changes for word in ("--set", change)]
    assert call("run", SLIDER, "-o", "x.h5", "-q", "--engine", "batch", *TWO_WAY, *words).code == 0
    with h5py.File(here / "x.h5") as file:
        assert file["landmarks/kind"].size > 4
    assert call("verify", "x.h5").code == 0


def test_verify_counts_phases_again(ran: Path) -> None:
    """A summary that does not belong to the rows is found, also where nobody looks at hashes."""
    with h5py.File(ran, "r+") as file:
        file["summary"].attrs["stick_fraction"] += 1e-6
    done = call("verify", ran)
    assert done.code == 3
    assert "/summary stick_fraction" in done.out + done.err


def test_compare_has_the_exact_laws_and_leaves_the_one_way_motion_out(ran: Path) -> None:
    done = call("compare", ran, "--json")
    assert done.code == 0, done.err
    told = json.loads(done.out)
    assert "energy" in told["identities"]
    assert "this slider pushes back" in told["left_out"]["displacement"]["note"]
    assert "displacement_std" not in done.out
    assert "begins" not in told["balance"]
    shown = call("compare", ran).out
    assert "energy (uN um)" in shown


def test_compare_rejects_a_balance_that_is_not_that_of_its_rows(ran: Path) -> None:
    with h5py.File(ran, "r+") as file:
        file["balance/velocity_squared_integral"][0] *= 1.0 + 1e-5
    done = call("compare", ran)
    assert done.code == 3
    assert "energy" in done.err


def test_it_opens_in_python_and_xarray(ran: Path) -> None:
    with rubnoise.open(ran) as run:
        landmarks = run.to_xarray()["landmarks"]
        assert landmarks["kind"].attrs["flag_meanings"] == "stick slip reversal forward"
        assert set(run.slider["phase"][:].tolist()) <= {0, 1, 2}
        early, late = run.junction(0), run.junction(400)
        assert np.isnan(early.birth_time)
        assert late.death_time > late.birth_time > 0.0
    with xarray.open_dataset(ran, group="landmarks", engine="h5netcdf") as found:
        assert list(found.sizes) == ["landmark"]


def test_junctions_and_tables_are_told(ran: Path) -> None:
    told = json.loads(call("junction", ran, "0", "--json").out)
    assert told["birth_time"] is None
    assert told["death_time"] > 0.0
    assert call("junction", ran, "400").code == 0
    table = call("export", ran, "--to", "csv", "--group", "landmarks", "-o", "-").out.splitlines()
    assert table[0].startswith("landmark,time_s,distance_um,kind,")
    assert len(table) > 20


def test_a_lesson_is_made_of_it(ran: Path, here: Path) -> None:
    assert call("teach", ran, "-o", "page.html").code == 0
    assert (here / "page.html").stat().st_size > 100_000


def test_it_is_drawn_and_laid_over_the_one_way_run(ran: Path, here: Path) -> None:
    for what in ("trace", "lives", "histogram", "psd", "acf", "count", "slider", "phase", "landmarks"):
        assert call("plot", ran, what).out == f"x_{what}.png\n"
    assert call("run", SLIDER, "-o", "one.h5", "-q", *SHORT).code == 0
    for words in (("slider",), ("phase",), ("psd", "--of", "velocity")):
        alone, both = (call("plot", "one.h5", *words, "-o", f"{name}.png", "--force") for name in ("alone", "both"))
        assert (alone.code, both.code) == (0, 0)
        assert call("plot", "one.h5", *words, "--with", ran, "-o", "both.png", "--force").code == 0
        assert (here / "alone.png").read_bytes() != (here / "both.png").read_bytes()


def test_it_is_heard(ran: Path, here: Path) -> None:
    assert call("listen", ran, "-o", "x.wav", "--speed-up", "10").code == 0
    with h5py.File(ran) as file, wave.open(str(here / "x.wav")) as sound:
        rows, tick = file["slider/velocity"].size, float(file["slider/time"][1])
        assert sound.getnframes() == pytest.approx(rows * tick / 10.0 * sound.getframerate(), rel=1e-3, abs=2)
        samples = np.frombuffer(sound.readframes(-1), "u1").reshape(-1, 3).astype(np.int64) @ [1, 256, 65536]
        heard = np.where(samples < 1 << 23, samples, samples - (1 << 24)) / (1 << 23)
        velocity = file["slider/velocity"][:]
    at = np.arange(heard.size) / sound.getframerate() * 10.0 / tick
    shown = np.interp(at, np.arange(rows), velocity)
    assert np.corrcoef(heard, shown)[0, 1] > 0.98


def test_in_memory_it_is_the_same(ran: Path) -> None:
    overrides = [word for word in TWO_WAY if word != "--set"]
    record = rubnoise.simulate(rubnoise.load(SLIDER, overrides))
    with rubnoise.open(ran) as run:
        assert np.array_equal(record["slider"]["velocity"], run.slider["velocity"][:])
        assert len(record.to_xarray()["landmarks"]["kind"]) == len(run.to_xarray()["landmarks"]["kind"])
    with pytest.raises(Refused, match="takes interventions"):
        rubnoise.simulate(rubnoise.load(SLIDER, overrides), intervene=lambda env, _live: env.timeout(1.0))


def test_a_sweep_of_both_couplings_keeps_what_each_has(here: Path) -> None:
    Path("s.toml").write_text(
        f'format = 1\nextends = "{SLIDER}"\n[sliding]\ndistance = "1 mm"\n[output]\ntick = "1 um"\n'
        '[sweep]\nreplicates = 2\n[sweep.grid]\nslider.coupling = ["one-way", "two-way"]\n'
    )
    assert call("sweep", "s.toml", "-o", "d", "-q", "--jobs", "1").code == 0
    with rubnoise.open_sweep("d") as found:
        sticks = np.asarray(found.runs["stick_fraction"][:])
        excess = np.asarray(found.runs["mean_force_excess"][:])
        spreads, seeds = np.asarray(found.runs["displacement_std"][:]), found.runs["seed"][:]
    assert np.isnan(sticks[:2]).all()
    assert (sticks[2:] > 0.2).all()
    assert np.isfinite(excess[2:]).all()
    with h5py.File("d/index.h5") as index:
        units = {name: column.attrs.get("units") for name, column in index["runs"].items()}
    assert units["stick_fraction"] == units["energy_residual"] == b"1"
    assert units["sticks_per_s"] == units["slips_longer_than_d_per_s"] == units["reversals_per_s"] == b"1/s"
    assert units["mean_force_excess"] == units["mean_force_excess_exact"] == b"uN"
    assert seeds[:2].tolist() == seeds[2:].tolist()
    assert call("verify", "d").code == 0
    assert call("plot", "d", "displacement_std", "-o", "d.png").code == 0
    asked = ("info", "d", "--figures", "displacement_std, stick_fraction")
    told = call(*asked, "--over", "slider.coupling=one-way", "--json").json()["estimates"]
    assert [point["values"] for point in told] == [{"slider.coupling": "one-way"}, {"slider.coupling": "two-way"}]
    two_way = told[1]
    assert two_way["figures"]["stick_fraction"]["value"] == pytest.approx(sticks[2:].mean())
    assert two_way["over"]["displacement_std"]["value"] == pytest.approx(
        np.sqrt((spreads[2:] ** 2).sum() / (spreads[:2] ** 2).sum())
    )
    assert two_way["over"]["displacement_std"]["low"] < two_way["over"]["displacement_std"]["value"]
    assert told[0]["figures"]["stick_fraction"]["value"] is None
    shown = call(*asked, "--over", "slider.coupling=one-way").out
    assert "slider.coupling = two-way" in shown
    assert "stick fraction" in shown
    assert "+-" in shown
