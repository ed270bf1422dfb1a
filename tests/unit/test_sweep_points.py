"""A sweep file: the runs that it stands for, and its problems."""

from math import sqrt
from pathlib import Path

import pytest

from rubnoise.scenario import build
from rubnoise.scenario.sweep import Sweep, canonical, expand
from rubnoise.streams import SEED_LIMIT
from tests.unit.scenarios import GRID, HEAD, sweep_of

# A sweep file stands for the runs that it says, each with a name and a seed that nothing else moves.
COUNT = "interface.mean_junction_count"
AREA = "interface.mean_real_contact_area"


def test_a_grid_is_the_product_in_the_order_written(tmp_path: Path) -> None:
    sweep = sweep_of(tmp_path, GRID)
    assert sweep.keys == (AREA, COUNT)
    told = [(*point.values.values(), point.replicate) for point in expand(sweep)]
    assert told == [(area, count, n) for area in ("100 um^2", "200 um^2") for count in (10, 20, 30) for n in (0, 1)]


def test_a_zip_goes_side_by_side_within_the_grid(tmp_path: Path) -> None:
    table = (
        '[sweep.zip]\ndiameter.law = ["fixed", "normal"]\noutput.tick = ["0.1 um", "0.2 um"]\n'
        "[sweep.grid]\ninterface.mean_junction_count = [10, 20]\n"
    )
    head = HEAD + '[diameter]\nlaw = "normal"\nspread = "0.2 um"\n'
    sweep = sweep_of(tmp_path, table.replace('"fixed"', '"normal"'), head=head)
    told = [tuple(point.values.values()) for point in expand(sweep)]
    assert told == [(count, "normal", tick) for count in (10, 20) for tick in ("0.1 um", "0.2 um")]


def test_a_point_is_the_scenario_that_a_file_of_its_own_would_be(tmp_path: Path) -> None:
    for point in expand(sweep_of(tmp_path, GRID)):
        own = {
            "format": 1,
            "title": "swept",
            "interface": {"mean_real_contact_area": point.values[AREA], "mean_junction_count": point.values[COUNT]},
            "sliding": {"distance": "2 mm"},
            "run": {"seed": point.seed, "engine": "batch"},
        }
        assert point.scenario.resolved() == build(own).resolved()
        assert point.scenario.model().calibrated_diameter == pytest.approx(
            sqrt(3.0 * float(point.scenario.interface.mean_real_contact_area) / point.values[COUNT]), rel=1e-14
        )


def test_seeds_and_names_are_all_different_and_in_range(tmp_path: Path) -> None:
    points = expand(sweep_of(tmp_path, GRID.replace("replicates = 2", "replicates = 50")))
    assert len({point.seed for point in points}) == len({point.run_id for point in points}) == len(points) == 300
    assert all(0 <= point.seed < SEED_LIMIT and point.scenario.run.seed == point.seed for point in points)
    assert all(len(point.run_id) == 16 and int(point.run_id, 16) >= 0 for point in points)


@pytest.mark.parametrize(
    "table",
    [
        GRID.replace("[10, 20, 30]", "[30, 10, 20, 40]"),
        GRID.replace("replicates = 2", "replicates = 5"),
        GRID.replace("100 um^2", "0.0001 mm^2").replace("[10,", "[10.0,"),
        "[sweep]\nreplicates = 2\n[sweep.grid]\n" + "\n".join(reversed(GRID.splitlines()[3:])) + "\n",
        GRID + '[sweep.zip]\ninterface.calibration = ["matched"]\n',
    ],
    ids=["in another order, with a point more", "more replicates", "other units", "other order of keys", "another key"],
)
def test_a_seed_follows_from_its_point_alone(tmp_path: Path, table: str) -> None:
    def named(sweep: Sweep) -> dict[tuple[str, float, int], tuple[int, str]]:
        contacts = ((point, point.scenario.interface) for point in expand(sweep))
        return {
            (area.mean_real_contact_area.as_text(), area.mean_junction_count, point.replicate): (
                point.seed,
                point.run_id,
            )
            for point, area in contacts
        }

    assert named(sweep_of(tmp_path, GRID)).items() <= named(sweep_of(tmp_path, table)).items()


def test_the_seeds_of_a_point_do_not_change_with_versions(tmp_path: Path) -> None:
    points = expand(sweep_of(tmp_path, GRID))
    assert [(point.seed, point.run_id) for point in points[:2]] == KEPT


def test_how_a_run_is_written_changes_its_name_and_not_its_seed(tmp_path: Path) -> None:
    table = '[sweep.grid]\noutput.tick = ["0.1 um", "0.2 um"]\n'
    fine, coarse = expand(sweep_of(tmp_path, table))
    assert fine.seed == coarse.seed
    assert fine.run_id != coarse.run_id
    retitled = expand(sweep_of(tmp_path, table, "title=another"))
    assert [(p.seed, p.run_id) for p in retitled] == [(p.seed, p.run_id) for p in (fine, coarse)]


def test_both_couplings_meet_the_same_junctions(tmp_path: Path) -> None:
    both = 'slider.coupling = ["one-way", "two-way"]\n'
    table = f'[sweep]\nreplicates = 3\n[sweep.grid]\n{both}sliding.speed = ["1 mm/s", "1 m/s"]\n'
    slider = '[strength]\nmean = "250 MPa"\n[slider]\nmass = "5 g"\nstiffness = "300 N/m"\ndamping_ratio = 0.02\n'
    points = expand(sweep_of(tmp_path, table, head=HEAD + slider))
    one_way, two_way = points[:6], points[6:]
    assert [point.seed for point in one_way] == [point.seed for point in two_way]
    assert len({point.seed for point in one_way}) == 6
    assert len({point.run_id for point in points}) == 12
    # A scenario without coupling has the seeds that it always had.
    alone = expand(sweep_of(tmp_path, table.replace(both, ""), head=HEAD + slider))
    assert [point.seed for point in alone] == [point.seed for point in one_way]


def test_defaults_have_no_part_in_names_and_seeds(tmp_path: Path) -> None:
    told, untold = (expand(sweep_of(tmp_path, GRID, *changes))[3] for changes in ((), ("pulse.shape=lens",)))
    assert (told.seed, told.run_id) == (untold.seed, untold.run_id)
    assert canonical(told.scenario.resolved(), without=("run", "output")) == (
        b'{"format":1,"interface":{"mean_junction_count":20.0,"mean_real_contact_area":"100 um^2"},'
        b'"sliding":{"distance":"2000 um"},"title":"swept"}'
    )
    other = expand(sweep_of(tmp_path, GRID, "pulse.shape=triangle"))[3]
    assert other.seed != told.seed


KEPT = [(765688994715997, "22bead39afcfb42b"), (3070721805695893, "2b2f8947c938dbec")]

# All problems of a sweep are reported at once, each one time, with its place.


def test_what_said_the_first_calibration_keeps_its_name_and_seed(tmp_path: Path) -> None:
    # Name and seed are those of the version whose default was exact, where no file had to say it.
    sweep = sweep_of(tmp_path, GRID, "interface.calibration=exact")
    first = next(point for point in expand(sweep) if point.replicate == 0)
    assert (first.run_id, first.seed) == ("22bead39afcfb42b", 765688994715997)
