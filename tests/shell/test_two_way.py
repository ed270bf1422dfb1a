"""A scenario whose slider pushes back, from `check` to `verify`: run, opened and looked at."""

import json
import re
from pathlib import Path

import h5py
import numpy as np
import pytest

import rubnoise
from tests.shell.terminal import call, columns
from tests.shell.test_signals import SHORT, SLIDER

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
    assert call("run", SLIDER, "-o", "one.h5", "-q", "--seed", "3", *short).code == 0
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


@pytest.mark.slow
@pytest.mark.parametrize("cells", ["20", "400"])
@pytest.mark.parametrize("count", ["1", "20"])
def test_a_right_run_keeps_all_of_it(here: Path, count: str, cells: str) -> None:
    changes = (f"interface.mean_junction_count={count}", f"slider.cells={cells}", "interface.calibration=exact")
    words = [word for change in changes for word in ("--set", change)]
    assert call("run", SLIDER, "-o", "x.h5", "-q", "--engine", "batch", *TWO_WAY, *words).code == 0
    with h5py.File(here / "x.h5") as file:
        assert file["landmarks/kind"].size > 4
    assert call("verify", "x.h5").code == 0


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


@pytest.mark.slow
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
    told = call(*asked, "--over", "slider.coupling=one-way", "--json").json()
    spread, stuck = told["displacement_std"], told["stick_fraction"]
    assert spread["slider.coupling"] == stuck["slider.coupling"] == ["one-way", "two-way"]
    assert stuck["value"] == [None, pytest.approx(sticks[2:].mean())]
    assert spread["ratio_value"][1] == pytest.approx(np.sqrt((spreads[2:] ** 2).sum() / (spreads[:2] ** 2).sum()))
    assert spread["ratio_low"][1] < spread["ratio_value"][1]
    shown = call(*asked, "--over", "slider.coupling=one-way").out
    assert "stick fraction\n" in shown
    assert re.search(r"^ +two-way +0\.[5-9]", shown, re.MULTILINE)
