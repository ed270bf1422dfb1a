"""Level of the noise over roughness and cut-off of two surfaces.

Synthetic surfaces go the whole way: spectra, theory of the contact, scenario with the slider's mass, a run of it, which
has to be within four standard errors of the scenario's theory.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from math import log, log10
from typing import Final

from parts import table

import rubnoise
from rubnoise.record.tally import Tally
from rubnoise.scenario import loads
from rubnoise.simulation.run import simulate
from rubnoise.theory.load import level, load_motion
from rubnoise.theory.sampling import load_errors
from studies.study import Study

POINTS: Final = 1024
HURST: Final = 0.8
ROLLOFF: Final = 128.0
ROUGHNESSES: Final = (0.3, 1.0, 3.0)
CUTOFFS: Final = (8.0, 16.0, 32.0)
"""Of each surface, in um; its points are 1 um apart."""

LOAD: Final = 10.4
MASS: Final = LOAD / 9.81
"""In N and kg: the slider rests under its own weight, and 1 % of the area is in contact."""

SPEED: Final = 30_000.0
RATIO: Final = 0.3
SEED: Final = 381
ALLOWED: Final = 4.0


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One roughness and cut-off: the contact, and levels of the normal velocity in dB re 50 nm/s.

    surfaces: by first order from both spectra; exact, found: of the scenario, by first order and in a run.
    """

    roughness: float
    cutoff: float
    junction_count: float
    relative_speed: float
    surfaces: float
    exact: float
    found: float
    error: float


def measured(roughness: float, cutoff: float, seed: int) -> Cell:
    """Return a cell, from two surfaces and one run of their scenario."""
    track, slider = (
        rubnoise.Surface.synthesise(
            points=POINTS,
            roughness=f"{roughness} um",
            hurst=HURST,
            rolloff=f"{ROLLOFF} um",
            cutoff=f"{cutoff} um",
            seed=n,
        )
        for n in (1, 2)
    )
    contact = track.slide(slider, cutoff=f"{cutoff} um", load=f"{LOAD} N", hardness="1 GPa")
    text = contact.scenario_text(speed=SPEED, mass=MASS, damping_ratio=RATIO)
    model = loads(text).model()
    tally, motion = Tally.of(model), load_motion(model)
    simulate(model, seed, tally, engine="batch")
    relative = load_errors(model, model.distance).velocity_std / motion.velocity_std
    return Cell(
        roughness=roughness,
        cutoff=cutoff,
        junction_count=contact.gaussian.junction_count,
        relative_speed=motion.relative_speed,
        surfaces=contact.motions(speed=SPEED, mass=MASS, damping_ratio=RATIO)[0].velocity_level,
        exact=motion.velocity_level,
        found=level(tally.moments["normal_velocity"].std),
        error=20.0 / log(10.0) * relative,
    )


def made() -> Iterator[Cell]:
    """Yield a cell for each roughness and cut-off."""
    return (measured(*place, SEED + n) for n, place in enumerate(product(ROUGHNESSES, CUTOFFS)))


def faults(cells: Sequence[Cell]) -> list[str]:
    """Return the cells in which the run is not what the scenario's theory says."""
    return [str(each) for each in cells if abs(each.found - each.exact) > ALLOWED * each.error]


def tables(cells: Sequence[Cell]) -> dict[str, str]:
    """Return the table of the page, a row for each roughness."""

    def row(roughness: float) -> list[Cell]:
        return [each for each in cells if each.roughness == roughness]

    counts = ("", *(f"{each.junction_count:.3g} junctions" for each in row(ROUGHNESSES[0])))
    told = ((f"{roughness:g} µm", *map(_told, row(roughness))) for roughness in ROUGHNESSES)
    head = ("rms height of each", *(f"cut-off {cutoff:g} µm" for cutoff in CUTOFFS))
    return {"surface levels": table(head, (counts, *told))}


def _told(each: Cell) -> str:
    return f"{each.surfaces:.1f} dB; scenario {each.exact:.1f}, run {each.found:.1f} ± {each.error:.1f}"


def exponent(cells: Sequence[Cell], cutoff: float) -> float:
    """Return d ln level / d ln roughness by theory at a cut-off, over all roughnesses."""
    own = [each for each in cells if each.cutoff == cutoff]
    return (own[-1].exact - own[0].exact) / (20.0 * log10(own[-1].roughness / own[0].roughness))


STUDY: Final = Study(
    about=__doc__,
    page="surfaces.md",
    data="surface_levels.json",
    row=Cell,
    facts={"points": POINTS, "hurst": HURST, "rolloff": ROLLOFF, "load": LOAD, "speed": SPEED, "seed": SEED},
    make=made,
    faults=faults,
    tables=tables,
)
