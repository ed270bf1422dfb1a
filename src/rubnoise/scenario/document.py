"""The keys of a scenario file, section by section, with what each may hold."""

from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BaseModel, ConfigDict, create_model
from pydantic import Field as About

from rubnoise.contact.births import BIRTHS
from rubnoise.contact.laws import LAWS
from rubnoise.scenario import limits
from rubnoise.scenario.fields import Choice, Line, Measure, Number, Parts, Range, Sizes
from rubnoise.streams import SEED_LIMIT
from rubnoise.units import AREA, DAMPING, FORCE, INVERSE_SPEED, LENGTH, MASS, RATIO, SPEED, STIFFNESS, STRESS, Quantity

FORMAT = 1
ONE_STRENGTH = "constant"
"""The strength table's word for the law that the registry calls fixed."""
AREAS, COUNTS = Range(1e-12, 1e18), Range(1e-6, limits.LIVE_JUNCTIONS)
"""Mean real contact areas in um^2 and mean numbers of junctions that are possible."""


class Section(BaseModel):
    """A table whose keys are all known."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)


class Interface(Section):
    """The contact: mean real contact area, or load and hardness; mean number of junctions, or the area of one."""

    mean_real_contact_area: Annotated[
        Quantity | None,
        Measure((AREA,), possible=AREAS, plausible=Range(1e-6, 1e12)),
        About(description="Mean real contact area A_rm; or else load and hardness."),
    ] = None
    load: Annotated[
        Quantity | None,
        Measure((FORCE,), possible=Range(1e-12, 1e18), plausible=Range(1e-3, 1e12)),
        About(description="Normal load W; with hardness, A_rm = W/H (Bowden and Tabor)."),
    ] = None
    hardness: Annotated[
        Quantity | None,
        Measure((STRESS,), possible=Range(1e-12, 1e12), plausible=Range(1e-2, 1e6)),
        About(description="Hardness H of the softer side; psi/H is the coefficient of friction."),
    ] = None
    mean_junction_count: Annotated[
        float | None,
        Number(COUNTS),
        About(description="Mean number of junctions N_jm; need not be a whole number; or else patch_area."),
    ] = None
    patch_area: Annotated[
        Quantity | None,
        Measure((AREA,), possible=AREAS, plausible=Range(1e-6, 1e12)),
        About(description="Mean area of one junction, so that N_jm = A_rm/patch_area: load adds junctions."),
    ] = None
    calibration: Annotated[
        str,
        Choice(("paper", "exact", "matched")),
        About(description="Life mean over d_m^2: paper 0.327 (lens), exact the pulse's own, matched solves for A_rm."),
    ] = "matched"


def _listed(one_value: str) -> str:
    """Return every law with its description in the registry; the law of one value has a name for each table."""
    known = {name: entry for name, entry in LAWS.items() if one_value == "fixed" or not entry.own_keys}
    return "; ".join(f"{one_value if name == 'fixed' else name}: {entry.about}" for name, entry in known.items())


def _without_spread(one_value: str) -> str:
    taking = {name: entry for name, entry in LAWS.items() if one_value == "fixed" or not entry.own_keys}
    names = [one_value if name == "fixed" else name for name, entry in taking.items() if not entry.takes_spread]
    return f"{', '.join(names[:-1])} and {names[-1]}"


def _with_parameters(table: type[Section], centre: str) -> Any:
    """Return a table with the additional keys of each law of the registry."""
    keys: dict[str, Any] = {}
    for name, entry in LAWS.items():
        for each in entry.parameters:
            about = About(description=f"{each.about.format(centre=centre)}; for the law {name}.")
            keys[each.name] = (Annotated[float | None, Number(Range(each.low, each.high)), about], None)
    return create_model(table.__name__, __base__=table, __doc__=table.__doc__, **keys)


class Diameter(Section):
    """The distribution of junction diameters about the calibrated diameter d_m."""

    law: Annotated[
        str,
        Choice(tuple(LAWS)),
        About(description=f"{_listed('fixed')}."),
    ] = "fixed"
    spread: Annotated[
        Quantity | None,
        Measure((LENGTH, RATIO), possible=Range(1e-12, 1e12, zero=True), plausible=Range(1e-6, 1e6, zero=True)),
        About(description=f"Standard deviation: a length, or a percentage of d_m; not for {_without_spread('fixed')}."),
    ] = None
    weights: Annotated[
        tuple[float, ...] | None,
        Sizes("weights"),
        About(description="Weight of each part, made to add up to 1; for the law mixture."),
    ] = None
    parts: Annotated[
        tuple[dict[str, Any], ...] | None,
        Parts(),
        About(description="Tables with law, mean (um) and, where the law takes one, spread (%); scaled to d_m."),
    ] = None
    values: Annotated[
        tuple[float, ...] | None,
        Sizes("diameters"),
        About(description="Measured diameters in um, which are scaled to the mean d_m; for the law empirical."),
    ] = None
    file: Annotated[
        str | None,
        Line(),
        About(description="File with the values, CSV or HDF5, relative to the scenario's; for the law empirical."),
    ] = None
    column: Annotated[
        str | None,
        Line(),
        About(description="Column of the file, by name or number, or dataset; a table of one column needs none."),
    ] = None
    hash: Annotated[
        str | None,
        Line(),
        About(description="SHA-256 of the values in um; a file that has changed is refused. Filled in when left out."),
    ] = None
    sampled: Annotated[
        str | None,
        Choice(("born", "alive")),
        About(description="How values were found: born, each counts alike; alive, in a snapshot, by one over itself."),
    ] = None


def _about_birth(key: str) -> Any:
    name, about = next((name, each.about) for name, entry in BIRTHS.items() for each in entry.keys if each.name == key)
    return About(description=f"{about}; for the law {name}.")


class Birth(Section):
    """The positions of births along the sliding distance."""

    law: Annotated[
        str,
        Choice(tuple(BIRTHS)),
        About(description=f"{'; '.join(f'{name}: {entry.about}' for name, entry in BIRTHS.items())}."),
    ] = "poisson"
    shape: Annotated[float | None, Number(Range(0.125, 100.0)), _about_birth("shape")] = None
    cluster_size: Annotated[float | None, Number(Range(0.1, 1e4)), _about_birth("cluster_size")] = None
    cluster_width: Annotated[
        Quantity | None,
        Measure((LENGTH,), possible=Range(1e-12, 1e12), plausible=Range(1e-6, 1e6)),
        _about_birth("cluster_width"),
    ] = None
    jitter: Annotated[
        Quantity | None,
        Measure((RATIO,), possible=Range(1e-6, 1e2), plausible=Range(1e-6, 1e2)),
        _about_birth("jitter"),
    ] = None


class Pulse(Section):
    """The area of a junction over its life."""

    shape: Annotated[
        str,
        Choice(("lens", "triangle", "parabola")),
        About(
            description="lens: the overlap of two circles; triangle: a straight rise and fall to the same peak; "
            "parabola: the overlap of two paraboloids, as rough surfaces have it."
        ),
    ] = "lens"
    offset: Annotated[
        str,
        Choice(("none", "uniform")),
        About(
            description="none: junctions pass through both centres; uniform: they miss the centre line by up to the "
            "diameter (lens and parabola, Poisson births, one-way coupling)."
        ),
    ] = "none"


class Strength(Section):
    """The shear strength of junctions, which turns area into force."""

    law: Annotated[
        str,
        Choice((ONE_STRENGTH, *(name for name, entry in LAWS.items() if name != "fixed" and not entry.own_keys))),
        About(description=f"{_listed(ONE_STRENGTH)}."),
    ] = ONE_STRENGTH
    mean: Annotated[
        Quantity,
        Measure((STRESS,), possible=Range(1e-12, 1e12), plausible=Range(1e-3, 1e6)),
        About(description="Mean shear strength psi; for normal before redrawing, for power the unit of its ends."),
    ]
    spread: Annotated[
        Quantity | None,
        Measure((STRESS, RATIO), possible=Range(1e-12, 1e12, zero=True), plausible=Range(1e-6, 1e6, zero=True)),
        About(
            description=f"Standard deviation: a stress, or a percentage of the mean; not for "
            f"{_without_spread(ONE_STRENGTH)}."
        ),
    ] = None


if not TYPE_CHECKING:  # the keys that a law brings along are known to the registry alone
    Diameter = _with_parameters(Diameter, "d_m")
    Strength = _with_parameters(Strength, "the mean")


class Sliding(Section):
    """Sliding distance and speed."""

    distance: Annotated[
        Quantity,
        Measure((LENGTH,), possible=Range(1e-9, 1e30), plausible=Range(1e-3, 1e12)),
        About(description="Sliding distance of the run."),
    ]
    speed: Annotated[
        Quantity | None,
        Measure((SPEED,), possible=Range(1e-9, 1e15), plausible=Range(1e-3, 1e9)),
        About(description="Sliding speed; without it, no times are written."),
    ] = None
    start: Annotated[
        str,
        Choice(("stationary", "empty")),
        About(description="stationary: junctions of all ages are alive at the start; empty: there are none."),
    ] = "stationary"


class Slider(Section):
    """The oscillator that the friction force excites; give either damping or damping_ratio."""

    mass: Annotated[
        Quantity,
        Measure((MASS,), possible=Range(1e-18, 1e12), plausible=Range(1e-12, 1e6)),
        About(description="Mass m."),
    ]
    stiffness: Annotated[
        Quantity,
        Measure((STIFFNESS,), possible=Range(1e-12, 1e15), plausible=Range(1e-4, 1e11)),
        About(description="Stiffness k."),
    ]
    damping: Annotated[
        Quantity | None,
        Measure((DAMPING,), possible=Range(1e-15, 1e15), plausible=Range(1e-9, 1e9)),
        About(description="Damping coefficient c."),
    ] = None
    damping_ratio: Annotated[
        float | None, Number(Range(1e-9, 1e6)), About(description="Damping ratio c / (2 sqrt(k m)).")
    ] = None
    coupling: Annotated[
        str,
        Choice(("one-way", "two-way")),
        About(
            description="one-way: the motion of the slider does not change the sliding distance; two-way: it does, "
            "and the slider may stick and turn round."
        ),
    ] = "one-way"
    excitation: Annotated[
        str | None,
        Choice(("friction", "base", "velocity-weakening")),
        About(
            description="friction, the default: the force of the junctions; base: asperities lift the slider's base "
            "(Rice and Moslehy), which runs with lives that are triangles of one size; velocity-weakening: a mean "
            "force that falls with speed, without junctions, which theory alone has."
        ),
    ] = None
    asperity_height: Annotated[
        Quantity | None,
        Measure((RATIO, LENGTH), possible=Range(1e-9, 1e6), plausible=Range(1e-9, 1e6)),
        About(description="Height of a triangular impulse: a percentage of d, or a length; for base."),
    ] = None
    heights: Annotated[
        str | None,
        Choice(("highest", "sum")),
        About(description="sum: impulses add up also where asperities meet, of which a rigid body rides the highest."),
    ] = None
    slope: Annotated[
        Quantity | None,
        Measure((DAMPING,), possible=Range(1e-15, 1e15), plausible=Range(1e-9, 1e9)),
        About(description="By how much the force falls with speed; for velocity-weakening."),
    ] = None
    tolerance: Annotated[
        float | None,
        Number(Range(1e-12, 1e-4)),
        About(description="Error of each step of a two-way motion, relative to its deflection; default 1e-9."),
    ] = None
    start: Annotated[
        str,
        Choice(("equilibrium", "rest")),
        About(description="equilibrium: at rest at the static deflection under the mean force; rest: at zero."),
    ] = "equilibrium"


class Load(Section):
    """A load that weighs: the slider rises and falls under interface.load, of first order or free to leave its contact.

    First order needs either damping or damping_ratio, free motion either restitution or impact_damping.
    """

    height_scale: Annotated[
        Quantity,
        Measure((LENGTH,), possible=Range(1e-9, 1e9), plausible=Range(1e-4, 1e3)),
        About(description="Height scale s_0: rising by so much leaves 1/e of the real contact area."),
    ]
    mass: Annotated[
        Quantity,
        Measure((MASS,), possible=Range(1e-18, 1e12), plausible=Range(1e-12, 1e6)),
        About(description="Mass of what moves up and down."),
    ]
    damping: Annotated[
        Quantity | None,
        Measure((DAMPING,), possible=Range(1e-15, 1e15), plausible=Range(1e-9, 1e9)),
        About(description="Damping coefficient of the normal motion."),
    ] = None
    damping_ratio: Annotated[
        float | None,
        Number(Range(1e-9, 1e6)),
        About(description="Damping ratio of the contact resonance, c / (2 sqrt(W m / s_0))."),
    ] = None
    motion: Annotated[
        str,
        Choice(("first-order", "free")),
        About(
            description="first-order: the contact is a spring of stiffness W/s_0, for small motions; free: every"
            " junction pushes by itself, and the slider may leave its contact."
        ),
    ] = "first-order"
    restitution: Annotated[
        float | None,
        Number(Range(0.0, 1.0)),
        About(description="Restitution e of free motion: the force of an overlap that shrinks is e^2 as large."),
    ] = None
    impact_damping: Annotated[
        Quantity | None,
        Measure((INVERSE_SPEED,), possible=Range(1e-15, 1e15), plausible=Range(1e-9, 1e3)),
        About(description="Loss of free motion that grows with speed (Hunt and Crossley); instead of restitution."),
    ] = None


class Output(Section):
    """The ticks of the traces, and compression."""

    tick: Annotated[
        Quantity | None,
        Measure((LENGTH,), possible=Range(1e-9, 1e12), plausible=Range(1e-6, 1e6)),
        About(description="Distance between samples of the traces; default: mean life / 200."),
    ] = None
    compression: Annotated[str, Choice(("none", "gzip")), About(description="gzip: smaller files, but slower.")] = (
        "none"
    )


class SampledOutput(Output):
    """What is written, once the tick is known."""

    tick: Annotated[Quantity, Measure((LENGTH,), possible=Range(1e-300, 1e12), plausible=Range(1e-6, 1e6))]


class Run(Section):
    """Seed and engine."""

    seed: Annotated[
        int, Number(Range(0, SEED_LIMIT - 1), whole=True), About(description="Seed of all random numbers.")
    ] = 1
    engine: Annotated[
        str,
        Choice(("events", "batch")),
        About(description="events: junctions as SimPy processes; batch: the same result, faster, without events."),
    ] = "events"


class Document(Section):
    """A rubnoise scenario."""

    format: Annotated[int, Number(Range(FORMAT, FORMAT), whole=True), About(description="Version of this format: 1.")]
    title: Annotated[str, Line(), About(description="One line that describes the run.")] = ""
    interface: Interface
    diameter: Diameter = Diameter()
    birth: Birth = Birth()
    pulse: Pulse = Pulse()
    strength: Strength | None = None
    sliding: Sliding
    slider: Slider | None = None
    load: Load | None = None
    output: Output = Output()
    run: Run = Run()
