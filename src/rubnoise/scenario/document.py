"""The keys of a scenario file, table by table: what each may hold, its meaning, its default, and an ordinary value.

Checks, refusals, the template, the JSON schema and the pages read this file and nothing else. The docstring of a table
says what it is about, and then the meaning of each key.
"""

# ruff: noqa: RUF009  (what looks like a default that is shared describes the field)

from collections.abc import Mapping, Sequence
from dataclasses import MISSING, dataclass, field, fields
from math import ceil, fsum, inf, isfinite, sqrt
from typing import Any, Final, Literal, get_args, get_type_hints

from rubnoise.contact.births import BIRTHS
from rubnoise.contact.laws import LAWS, LawEntry
from rubnoise.figure_names import QUANTITIES
from rubnoise.scenario.fields import Choice, Line, Measure, Number, Parts, Range, Section, Sizes, key, keys_of, needed
from rubnoise.streams import SEED_LIMIT
from rubnoise.units import AREA, DAMPING, FORCE, INVERSE_SPEED, LENGTH, MASS, RATIO, SPEED, STIFFNESS, STRESS, Quantity

FORMAT: Final = 1
ONE_STRENGTH: Final = "constant"
"""The strength table's word for the law that the registry calls fixed."""
LIVE_JUNCTIONS: Final = 1e6
"""A block of a run holds about eleven times as many junctions as are alive at once, at some 500 bytes each."""

AREAS, COUNTS = Range(1e-12, 1e18), Range(1e-6, LIVE_JUNCTIONS)
"""Mean real contact areas in um^2 and mean numbers of junctions that are possible."""
_MASS: Final = Measure((MASS,), Range(1e-18, 1e12), Range(1e-12, 1e6))
_WIDTH: Final = Measure((LENGTH,), Range(1e-12, 1e12), Range(1e-6, 1e6))
_JITTER: Final = Measure((RATIO,), Range(1e-6, 1e2), Range(1e-6, 1e2))
_DAMPING: Final = Measure((DAMPING,), Range(1e-15, 1e15), Range(1e-9, 1e9))


@dataclass(frozen=True, slots=True, kw_only=True)
class Interface(Section):
    """The contact: mean real contact area, or load and hardness; mean number of junctions, or the area of one.

    mean_real_contact_area: Mean real contact area A_rm; or else load and hardness.
    load: Normal load W; with hardness, A_rm = W/H (Bowden and Tabor).
    hardness: Hardness H of the softer side; psi/H is the coefficient of friction.
    mean_junction_count: Mean number of junctions N_jm; need not be a whole number; or else patch_area.
    patch_area: Mean area of one junction, so that N_jm = A_rm/patch_area: load adds junctions.
    calibration: Life mean over d_m^2: paper 0.327 (lens), exact the pulse's own, matched solves for A_rm.
    """

    mean_real_contact_area: Quantity | None = key(
        Measure((AREA,), AREAS, Range(1e-6, 1e12)),
        sample="200 um^2",
        form='mean_real_contact_area = "200 um^2", or load and hardness, or diameter.mean',
    )
    load: Quantity | None = key(Measure((FORCE,), Range(1e-12, 1e18), Range(1e-3, 1e12)), sample="0.2 N")
    hardness: Quantity | None = key(Measure((STRESS,), Range(1e-12, 1e12), Range(1e-2, 1e6)), sample="1 GPa")
    mean_junction_count: float | None = key(
        Number(COUNTS), sample=20, form='mean_junction_count = 20 or patch_area = "10 um^2"'
    )
    patch_area: Quantity | None = key(Measure((AREA,), AREAS, Range(1e-6, 1e12)), sample="10 um^2")
    calibration: Literal["paper", "exact", "matched"] = key(Choice(("paper", "exact", "matched")), "matched")


STRENGTH_LAWS: Final = {
    ONE_STRENGTH if name == "fixed" else name: LAWS[name] for name in LAWS if not LAWS[name].own_keys
}
"""The laws of strengths by their names in a scenario."""


def _law(laws: Mapping[str, LawEntry], default: str) -> Any:
    about = "; ".join(f"{name}: {entry.about}" for name, entry in laws.items())
    return key(Choice(tuple(laws)), default, about=f"{about}.")


def _spread(laws: Mapping[str, LawEntry], kind: Any, of: str, sample: str, form: str) -> Any:
    possible, plausible = Range(1e-12, 1e12, zero=True), Range(1e-6, 1e6, zero=True)
    *names, last = (name for name, entry in laws.items() if not entry.takes_spread)
    about = f"Standard deviation: {of}; not for {', '.join(names)} and {last}."
    return key(Measure((kind, RATIO), possible, plausible), about=about, sample=sample, form=form)


def _own(laws: Mapping[str, LawEntry], name: str, kind: Any = None, centre: str = "") -> Any:
    """Return the key of a parameter that one of the laws takes."""
    law, own = next((law, each) for law, entry in laws.items() for each in entry.parameters if each.name == name)
    about = f"{own.about.format(centre=centre)}; for the law {law}."
    return key(kind or Number(Range(own.low, own.high)), about=about, sample=own.sample)


@dataclass(frozen=True, slots=True, kw_only=True)
class Diameter(Section):
    """The distribution of junction diameters, about its own mean or about the calibrated diameter d_m.

    mean: Mean diameter d_m as drawn, beside either mean_junction_count or an area; the other follows.
    weights: Weight of each part, made to add up to 1; for the law mixture.
    parts: Tables with law, mean (um) and, where the law takes one, spread (%); scaled to d_m.
    values: Measured diameters in um, which are scaled to the mean d_m; for the law empirical.
    file: File with the values, CSV or HDF5, relative to the scenario's; for the law empirical.
    column: Column of the file, by name or number, or dataset; a table of one column needs none.
    hash: SHA-256 of the values in um; a file that has changed is refused. Filled in when left out.
    sampled: How values were found: born, each counts alike; alive, in a snapshot, by one over itself.
    """

    law: str = _law(LAWS, "fixed")
    mean: Quantity | None = key(
        Measure((LENGTH,), Range(1e-9, 1e9), Range(1e-4, 1e5)),
        sample="5 um",
        remark="Instead of mean_real_contact_area and calibration.",
    )
    spread: Quantity | None = _spread(
        LAWS, LENGTH, "a length, or a percentage of d_m", "10 %", 'spread = "0.2 um" or spread = "4 %"'
    )
    weights: tuple[float, ...] | None = key(Sizes("weights"), sample=[0.7, 0.3])
    parts: tuple[dict[str, Any], ...] | None = key(
        Parts(),
        sample=[{"law": "fixed", "mean": 4.0}, {"law": "normal", "mean": 9.0, "spread": "20 %"}],
        form='parts = [{law = "fixed", mean = 4}, {law = "normal", mean = 9, spread = "20 %"}]',
    )
    values: tuple[float, ...] | None = key(
        Sizes("diameters"), sample=[4.1, 5.3, 6.0], form='values = [4.1, 5.3, 6.0] or file = "sizes.csv"'
    )
    file: str | None = key(Line(), sample="sizes.csv")
    column: str | None = key(Line(), sample="diameter")
    hash: str | None = key(Line(), sample="2b2a067e28d6b407c6503c591e07fe6db2e0bf09bff4e5ac753fa369e2e7cc35")
    sampled: str | None = key(Choice(("born", "alive")), sample="alive")
    exponent: float | None = _own(LAWS, "exponent")
    smallest: float | None = _own(LAWS, "smallest", centre="d_m")
    largest: float | None = _own(LAWS, "largest", centre="d_m")


@dataclass(frozen=True, slots=True, kw_only=True)
class Birth(Section):
    """The positions of births along the sliding distance."""

    law: str = _law(BIRTHS, "poisson")
    shape: float | None = _own(BIRTHS, "shape", Number(Range(0.125, 100.0)))
    cluster_size: float | None = _own(BIRTHS, "cluster_size", Number(Range(0.1, 1e4)))
    cluster_width: Quantity | None = _own(BIRTHS, "cluster_width", _WIDTH)
    jitter: Quantity | None = _own(BIRTHS, "jitter", _JITTER)


@dataclass(frozen=True, slots=True, kw_only=True)
class Pulse(Section):
    """The area of a junction over its life.

    shape: lens: the overlap of two circles; triangle: a straight rise and fall to the same peak; parabola: the overlap
        of two paraboloids, as rough surfaces have it.
    offset: none: junctions pass through both centres; uniform: they miss the centre line by up to the diameter (lens
        and parabola, Poisson births, one-way coupling).
    """

    shape: str = key(Choice(("lens", "triangle", "parabola")), "lens")
    offset: str = key(Choice(("none", "uniform")), "none")


@dataclass(frozen=True, slots=True, kw_only=True)
class Strength(Section):
    """The shear strength of junctions, which turns area into force.

    mean: Mean shear strength psi; for normal before redrawing, for power the unit of its ends.
    """

    law: str = _law(STRENGTH_LAWS, ONE_STRENGTH)
    mean: Quantity = needed(Measure((STRESS,), Range(1e-12, 1e12), Range(1e-3, 1e6)), sample="250 MPa")
    spread: Quantity | None = _spread(
        STRENGTH_LAWS, STRESS, "a stress, or a percentage of the mean", "20 %", 'spread = "50 MPa" or spread = "20 %"'
    )
    exponent: float | None = _own(LAWS, "exponent")
    smallest: float | None = _own(LAWS, "smallest", centre="the mean")
    largest: float | None = _own(LAWS, "largest", centre="the mean")


@dataclass(frozen=True, slots=True, kw_only=True)
class Sliding(Section):
    """Sliding distance and speed.

    distance: Sliding distance of the run.
    speed: Sliding speed; without it, no times are written.
    start: stationary: junctions of all ages are alive at the start; empty: there are none.
    """

    distance: Quantity = needed(Measure((LENGTH,), Range(1e-9, 1e30), Range(1e-3, 1e12)), sample="40 mm")
    speed: Quantity | None = key(
        Measure((SPEED,), Range(1e-9, 1e15), Range(1e-3, 1e9)), sample="20 mm/s", form='speed = "1 mm/s"'
    )
    start: Literal["stationary", "empty"] = key(Choice(("stationary", "empty")), "stationary")


@dataclass(frozen=True, slots=True, kw_only=True)
class Slider(Section):
    """The oscillator that the friction force excites; give either damping or damping_ratio.

    mass: Mass m.
    stiffness: Stiffness k.
    damping: Damping coefficient c.
    damping_ratio: Damping ratio c / (2 sqrt(k m)).
    coupling: one-way: the motion of the slider does not change the sliding distance; two-way: it does, and the slider
        may stick and turn round.
    excitation: friction, the default: the force of the junctions; base: asperities lift the slider's base (Rice and
        Moslehy), which runs with lives that are triangles of one size; velocity-weakening: a mean force that falls with
        speed, without junctions, which theory alone has.
    asperity_height: Height of a triangular impulse: a percentage of d, or a length; for base.
    heights: sum: impulses add up also where asperities meet, of which a rigid body rides the highest.
    slope: By how much the force falls with speed; for velocity-weakening.
    cells: Least number of cells per diameter in which a two-way motion knows the force; default 50.
    start: equilibrium: at rest at the static deflection under the mean force; rest: at zero.
    """

    mass: Quantity = needed(_MASS, sample="50 g", form='mass = "5 g"')
    stiffness: Quantity = needed(
        Measure((STIFFNESS,), Range(1e-12, 1e15), Range(1e-4, 1e11)), sample="100 kN/m", form='stiffness = "300 N/m"'
    )
    damping: Quantity | None = key(_DAMPING, sample="5 N*s/m", form='damping = "0.05 N*s/m" or damping_ratio = 0.02')
    damping_ratio: float | None = key(Number(Range(1e-9, 1e6)), sample=0.02, remark="Instead of damping.")
    coupling: Literal["one-way", "two-way"] = key(Choice(("one-way", "two-way")), "one-way")
    excitation: Literal["friction", "base", "velocity-weakening"] | None = key(
        Choice(("friction", "base", "velocity-weakening")), sample="friction"
    )
    asperity_height: Quantity | None = key(Measure((RATIO, LENGTH), Range(1e-9, 1e6), Range(1e-9, 1e6)), sample="2 %")
    heights: str | None = key(Choice(("highest", "sum")), sample="sum")
    slope: Quantity | None = key(_DAMPING, sample="10 N*s/m", form='slope = "0.1 N*s/m"')
    cells: int | None = key(Number(Range(20, 10_000), whole=True), sample=50, remark="Only for two-way coupling.")
    start: Literal["equilibrium", "rest"] = key(Choice(("equilibrium", "rest")), "equilibrium")


@dataclass(frozen=True, slots=True, kw_only=True)
class Load(Section):
    """A load that weighs: the slider rises and falls under interface.load, of first order or free to leave its contact.

    First order needs either damping or damping_ratio, free motion either restitution or impact_damping.

    height_scale: Height scale s_0: rising by so much leaves 1/e of the real contact area.
    mass: Mass of what moves up and down.
    damping: Damping coefficient of the normal motion.
    damping_ratio: Damping ratio of the contact resonance, c / (2 sqrt(W m / s_0)).
    motion: first-order: the contact is a spring of stiffness W/s_0, for small motions; free: every junction pushes by
        itself, and the slider may leave its contact.
    restitution: Restitution e of free motion: the force of an overlap that shrinks is e^2 as large.
    impact_damping: Loss of free motion that grows with speed (Hunt and Crossley); instead of restitution.
    """

    height_scale: Quantity = needed(Measure((LENGTH,), Range(1e-9, 1e9), Range(1e-4, 1e3)), sample="0.5 um")
    mass: Quantity = needed(_MASS, sample="5 g")
    damping: Quantity | None = key(_DAMPING, sample="4 N*s/m", form='damping_ratio = 0.05 or damping = "4 N*s/m"')
    damping_ratio: float | None = key(Number(Range(1e-9, 1e6)), sample=0.05, remark="Instead of damping.")
    motion: Literal["first-order", "free"] = key(Choice(("first-order", "free")), "first-order")
    restitution: float | None = key(
        Number(Range(0.0, 1.0)),
        sample=0.7,
        form='restitution = 0.7 or impact_damping = "60 s/m"',
        remark="Only for free motion.",
    )
    impact_damping: Quantity | None = key(
        Measure((INVERSE_SPEED,), Range(1e-15, 1e15), Range(1e-9, 1e3)), sample="60 s/m", remark="Only for free motion."
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class Output(Section):
    """The ticks of the traces, and compression.

    tick: Distance between samples of the traces; default: mean life / 200.
    compression: gzip: smaller files, but slower.
    """

    tick: Quantity | None = key(Measure((LENGTH,), Range(1e-9, 1e12), Range(1e-6, 1e6)), sample="0.1 um")
    compression: Literal["none", "gzip"] = key(Choice(("none", "gzip")), "none")


@dataclass(frozen=True, slots=True, kw_only=True)
class Run(Section):
    """Seed and engine.

    seed: Seed of all random numbers.
    engine: events: junctions as SimPy processes; batch: the same result, faster, without events.
    """

    seed: int = key(Number(Range(0, SEED_LIMIT - 1), whole=True), 1)
    engine: Literal["events", "batch"] = key(Choice(("events", "batch")), "events")


@dataclass(frozen=True, slots=True, kw_only=True)
class Document(Section):
    """A rubnoise scenario.

    format: Version of this format: 1.
    title: One line that describes the run.
    """

    format: int = needed(Number(Range(FORMAT, FORMAT), whole=True), sample=FORMAT)
    title: str = key(Line(), "")
    interface: Interface
    diameter: Diameter = field(default_factory=Diameter)
    birth: Birth = field(default_factory=Birth)
    pulse: Pulse = field(default_factory=Pulse)
    strength: Strength | None = None
    sliding: Sliding
    slider: Slider | None = None
    load: Load | None = None
    output: Output = field(default_factory=Output)
    run: Run = field(default_factory=Run)


TOP: Final = keys_of(Document)  # keys above all tables

SECTIONS: Final[Mapping[str, type[Section]]] = {
    name: next(each for each in (kind, *get_args(kind)) if isinstance(each, type) and issubclass(each, Section))
    for name, kind in get_type_hints(Document).items()
    if name not in TOP
}
"""The tables by their names."""


def presence(name: str) -> str:
    """Return whether a table is "needed", "optional", or has "defaults" for all of its keys."""
    about = next(each for each in fields(Document) if each.name == name)
    return "optional" if about.default is None else "needed" if about.default_factory is MISSING else "defaults"


SWEEP: Final = "sweep"  # the table of many runs, which is read apart: a scenario is one run

SWEEP_RUNS: Final = 100_000
FEWEST: Final = 8
"""Runs from which their scatter says how precise their mean is: to some 27 %, 1/sqrt(2 (n - 1))."""

Keep = Literal["runs", "summary"]

_SPARE: Final = 1.1
_AT_LEAST: Final = 0.125


@dataclass(frozen=True, slots=True, kw_only=True)
class Sweeping(Section):
    """Many runs from one file; `[sweep.grid]` and `[sweep.zip]` list the values that vary.

    keep: runs: a result file for each run; summary: only its figures and curves, without traces.
    precision: Target for the relative standard error of the quantity's mean; runs are added to meet it.
    quantity: The figure of a run that must reach this precision.
    most_replicates: Most runs of a point, even if it does not reach the precision.
    """

    replicates: int = key(
        Number(Range(1, SWEEP_RUNS), whole=True),
        1,
        about=f"Runs of each point, each with its own seed; with a precision, the first runs, {FEWEST} or more.",
    )
    keep: Keep = key(Choice(("runs", "summary")), "runs")
    precision: float | None = key(Number(Range(1e-6, 1.0)), sample=0.005)
    quantity: str = key(Choice(tuple(QUANTITIES)), "real_contact_area_std")
    most_replicates: int = key(Number(Range(FEWEST, SWEEP_RUNS), whole=True), 1000)

    @property
    def largest(self) -> int:
        """Largest number of runs of a point."""
        return self.replicates if self.precision is None else self.most_replicates

    def reached(self, values: Sequence[float]) -> float:
        """Return s / (sqrt(n) |mean|) of replicates without nan, s being their standard deviation.

        It is inf for fewer than two, and 0 for equal values.
        """
        finite = [value for value in values if isfinite(value)]
        if len(finite) < 2:
            return inf
        mean = fsum(finite) / len(finite)
        error = sqrt(fsum((value - mean) ** 2 for value in finite) / (len(finite) * (len(finite) - 1)))
        if error == 0.0:
            return 0.0
        return error / abs(mean) if mean else inf

    def wanted(self, values: Sequence[float]) -> int:
        """Return how many replicates a point should have, from its present ones; not more if it has its precision.

        At most twice as many at a time, since the scatter of few replicates is uncertain.
        """
        have, reached = len(values), self.reached(values)
        if self.precision is None or reached <= self.precision or have >= self.most_replicates:
            return have
        needed = min(2.0, _SPARE * (reached / self.precision) ** 2)
        return min(self.most_replicates, ceil(have * max(needed, 1.0 + _AT_LEAST)))
