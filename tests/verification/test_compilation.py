"""Every kernel is compiled for one kind of arrays only: a second kind would cost seconds in the middle of a run."""

from simpy import Environment
from simpy.events import ProcessGenerator

from rubnoise.contact.pulses import TRIANGLE
from rubnoise.simulation import slider
from rubnoise.simulation.intervention import LiveJunctions
from rubnoise.simulation.kernels import coarse, fine, grid, lens, triangle
from tests.cli.terminal import spawn_program
from tests.models import UNEQUAL, bare, model, recorded

KERNELS = (
    fine.deposit_by_chunks,
    coarse.deposit_coarse_lives,
    lens.deposit_fine_moments,
    triangle.deposit_areas,
    triangle.deposit_moments,
    slider.advance_slider,
    grid.count_live,
)
RUNS = (
    model(distance=600.0, tick=0.5),
    model(distance=30.0, tick=0.5, speed=20.0),
    model(distance=600.0, tick=0.5, pulse=TRIANGLE, births="regular"),
    model(distance=600.0, tick=0.5, strength=UNEQUAL, start="empty"),
    bare(distance=600.0),
)


def test_runs_of_all_kinds_share_one_compilation() -> None:
    # In a process of its own: another test may have called a kernel with arrays of another kind.
    done = spawn_program("from tests.verification.test_compilation import counted; print(counted())")
    assert (done.out, done.err) == ("{1}\n", "")


def counted() -> set[int]:
    """Run everything with both engines and return how often the kernels have been compiled."""
    for run in RUNS:
        for engine in ("events", "batch"):
            recorded(run, engine=engine)
    recorded(model(distance=600.0, tick=0.05), intervene=_end_all)
    return {len(kernel.signatures) for kernel in KERNELS}


def _end_all(env: Environment, live: LiveJunctions) -> ProcessGenerator:
    """End all junctions alive in the middle of a run."""
    yield env.timeout(max(300.0 - env.now, 0.0))
    for junction in live:
        live.end(junction.number)
