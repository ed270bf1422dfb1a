"""Every dataset of a result file, written once: name, type, unit and meaning. Data only."""

from collections.abc import Collection, Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, replace
from enum import IntEnum, IntFlag
from types import UnionType
from typing import Any, Final, Literal

import numpy as np

from rubnoise.record.rows import ContactKind, JunctionState, LandmarkKind, Phase

Feature = Literal["speed", "strength", "slider", "two-way", "offset", "load", "free", "base"]
"""What a scenario may add to the bare contact: times, forces, a slider, that it pushes back, passes off the
centre line, a load that weighs, that the slider may leave its contact, and a base that lifts it."""

Scalar = float | int | str  # what an attribute holds
FORMAT: Final = "rubnoise-run"
INDEX_FORMAT: Final = "rubnoise-sweep"
FORMATS: Final[Mapping[Any, str]] = {FORMAT: "the result of a run", INDEX_FORMAT: "the index of a sweep"}
FORMAT_VERSION: Final = 2
CONVENTIONS: Final = "CF-1.11"
CHUNK_ROWS: Final = 65_536  # in a chunk of a compressed column: a file with others is refused
HASH: Final = "xxh3_128"

ROOT: Final[Mapping[str, type | UnionType]] = dict.fromkeys(
    ("Conventions", "format", "format_version", "title", "source", "junction_area_formula"), Scalar
)
"""The attributes of the root, and what each may hold; NX_class and default are for viewers."""

INTERVENTION: Final = "intervention"
"""What /provenance has only of a run whose lives were ended from outside: the name of the function."""

_TEXTS: Final = "scenario_toml scenario_resolved software environment propagator_constants command started finished"
PROVENANCE: Final[Mapping[str, type | UnionType]] = {
    **dict.fromkeys(_TEXTS.split(), str),
    **dict.fromkeys(("seed", "stream_version", "calibrated_diameter"), Scalar),
}
"""The attributes of /provenance, and what each may hold: whether a number is right is for `verify` to say."""

TELLTALES: Final[Mapping[Feature, str]] = {
    "strength": "junctions/shear_strength",
    "speed": "junctions/birth_time",
    "slider": "slider",
    "two-way": "balance",
    "offset": "junctions/lateral_offset",
    "load": "load",
    "free": "junctions/encounter",
    "base": "slider/base_displacement",
}
"""What a file has with each feature alone."""

NEEDED: Final[Sequence[tuple[Feature, Sequence[Feature]]]] = (
    ("slider", ("speed",)),
    ("slider", ("strength", "base")),
    ("two-way", ("slider",)),
    ("free", ("load",)),
    ("free", ("speed",)),
)
"""Features that are never alone, each with those of which it needs one."""


Codes = tuple[tuple[int, str], ...]  # numbers, and what they mean


@dataclass(frozen=True, slots=True)
class Dataset:
    """One dataset of one dimension; ``needs`` names the feature without which it is absent.

    ``codes`` are the meanings of its whole numbers, or of their ``bits``.
    """

    name: str
    units: str
    symbol: str
    long_name: str
    _: KW_ONLY
    dtype: str = "<f8"
    needs: str | None = None
    codes: Codes = ()
    bits: bool = False

    @property
    def attributes(self) -> dict[str, Any]:
        """Unit, meaning and symbol by name, and what the CF conventions say of its codes."""
        said: dict[str, Any] = {"units": self.units, "long_name": self.long_name, "symbol": self.symbol}
        if self.codes:
            numbers = np.array([number for number, _ in self.codes], dtype=self.dtype)
            said["flag_masks" if self.bits else "flag_values"] = numbers
            said["flag_meanings"] = " ".join(meaning for _, meaning in self.codes)
        return said


@dataclass(frozen=True, slots=True, kw_only=True)
class Group:
    """Columns of equal length; the first is their dimension scale, ``plotted`` the one that viewers draw against it.

    ``needs``: features of which it needs one; with none it is always there. ``lacks``: those with which it is absent.
    """

    name: str
    long_name: str
    columns: tuple[Dataset, ...]
    plotted: str
    needs: tuple[str, ...] = ()
    lacks: tuple[str, ...] = ()

    def as_in(self, features: Collection[str]) -> "Group":
        """Return the group with its columns as a file with these features describes them."""
        said = {path: about for (path, feature), about in INSTEAD.items() if feature in features}
        columns = (replace(each, **said.get(f"{self.name}/{each.name}", {})) for each in self.columns)
        return replace(self, columns=tuple(columns), **said.get(self.name, {}))


def _codes(numbers: Iterable[IntEnum | IntFlag]) -> Codes:
    return tuple((number.value, str(number.name).lower()) for number in numbers)


INSTEAD: Final[Mapping[tuple[str, Feature], Mapping[str, Any]]] = {
    ("junctions", "free"): {
        "long_name": "every touch of a summit, from contact made to contact lost, cut where the run begins and ends"
    },
    ("load", "free"): {"long_name": "the slider as it rises and falls under its load, free to leave its contact"},
    ("load/separation", "free"): {"long_name": "separation of the surfaces less that at rest"},
    ("landmarks", "free"): {
        "long_name": "where the slider loses contact, and makes it again",
        "plotted": "impact_speed",
    },
    ("landmarks/kind", "two-way"): {"codes": _codes(LandmarkKind)},
}
"""What differs with a feature, of groups and columns by their paths."""

_CODES: Final = {
    "state": _codes(JunctionState),
    "phase": _codes(Phase),
    "kind": _codes([*LandmarkKind, *ContactKind]),
}
"""Codes of columns that have some, by name; those of a state are bits."""

_TABLE: Final = """
/junctions      diameter          -             whole life of every junction, in order of birth
junction       1    j         <i8 -        row number of the junction
encounter      1    i         <i8 free     number of the summit touched
birth_distance um   s_birth   <f8 -        sliding distance at first touch
death_distance um   s_death   <f8 -        sliding distance at separation
life_distance  um   L_j       <f8 -        sliding distance from birth to death
diameter       um   d         <f8 -        diameter of the two circles in contact
lateral_offset um   b         <f8 offset   distance of one circle's centre from the line of the other's, across the \
    motion
max_area       um^2 A_jmax    <f8 -        area at full overlap
max_overlap    um   delta_max <f8 free     largest overlap in height
shear_strength MPa  psi       <f8 strength shear strength of the junction
birth_time     s    t_birth   <f8 speed    time of first touch
death_time     s    t_death   <f8 speed    time of separation
state          1    state     |u1 -        what cut the life short (0: nothing, the life is complete)

/trace          real_contact_area -             the contact at every tick of sliding distance
distance          um   s   <f8 -        sliding distance
real_contact_area um^2 A_r <f8 -        real contact area
junction_count    1    N_j <u4 -        number of live junctions
friction_force    uN   F_s <f8 strength friction force

/slider         displacement      slider        motion of the slider, uniform in time
time              s    t     <f8 -        time
distance          um   s     <f8 -        sliding distance
friction_force    uN   F_s   <f8 strength friction force on the slider
base_displacement um   y     <f8 base     height of the base
displacement      um   x     <f8 -        displacement of the slider
velocity          um/s x'    <f8 -        velocity of the slider
phase             1    phase |u1 two-way  how the slider moves over the surface

/load           separation        load          the slider as it rises and falls under its load, to which both \
    friction_force belong; /junctions, real_contact_area and junction_count are those at the mean separation
time         s    t     <f8 - time
separation   um   z     <f8 - separation of the surfaces less its mean
velocity     um/s z'    <f8 - normal velocity of the slider
load         uN   P     <f8 - load that the junctions bear
live_overlap um   delta <f8 - mean overlap of the live junctions in height; nan without live junctions

/landmarks      displacement      two-way,free  where the slider sticks, breaks away and turns round
landmark     1    n     <i8 -       row number of the landmark
time         s    t     <f8 -       time
distance     um   s     <f8 -       sliding distance
kind         1    kind  |u1 -       what the slider begins
impact_speed um/s v_imp <f8 free    how fast the overlap grows where contact is made, and shrinks where it is lost
displacement um   x     <f8 slider  displacement of the slider
velocity     um/s x'    <f8 slider  velocity of the slider
force_before uN   F_-   <f8 two-way friction force on the slider just before
force_after  uN   F_+   <f8 two-way friction force on the slider just after

/balance        displacement      two-way       where a two-way run ends, and integrals over its whole motion
time                          s      t       <f8 - time at the end of the run
distance                      um     s       <f8 - sliding distance at the end of the run
displacement                  um     x       <f8 - displacement of the slider at the end
velocity                      um/s   x'      <f8 - velocity of the slider at the end
time_stuck                    s      t_stick <f8 - time that the slider has stuck
displacement_integral         um*s   I_x     <f8 - integral of the displacement over time
displacement_squared_integral um^2*s I_xx    <f8 - integral of the squared displacement over time
velocity_squared_integral     um^2/s I_vv    <f8 - integral of the squared velocity over time
friction_work                 uN*um  W       <f8 - work of friction: integral of the force that the contact bears \
    over the path
reverse_work                  uN*um  W_-     <f8 - the part of friction_work done in reversals

/life_curve     area_fraction     !offset,!free area of any junction: diameter^2 * interp(u), \
    u = (s - birth_distance)/diameter
u             1 u <f8 - sliding distance since birth over diameter
area_fraction 1 a <f8 - area of the junction over diameter squared

/life_table     area_fraction     offset        area of any junction: diameter^2 times what lies between the four \
    rows around its u and offset_fraction
u               1 u   <f8 - sliding distance since birth over half of the life, from 0 to 2
offset_fraction 1 b/d <f8 - size of the lateral offset over diameter, from 0 to 1 for each u
area_fraction   1 a   <f8 - area of the junction over diameter squared
"""
"""Groups: name, plotted column, needed features or !lacking ones, meaning; and name, unit, symbol, type, needed feature
and meaning of their columns."""


def _groups() -> Iterator[Group]:
    """Yield the groups of the table with their columns."""
    for block in _TABLE.strip().split("\n\n"):
        head, *lines = block.splitlines()
        name, plotted, needs, long_name = head.split(maxsplit=3)
        features = [each for each in needs.split(",") if each != "-"]
        yield Group(
            name=name[1:],
            long_name=" ".join(long_name.split()),
            columns=tuple(map(_column, lines)),
            plotted=plotted,
            needs=tuple(each for each in features if each[0] != "!"),
            lacks=tuple(each[1:] for each in features if each[0] == "!"),
        )


def _column(line: str) -> Dataset:
    name, units, symbol, dtype, needs, long_name = line.split(maxsplit=5)
    about, feature = " ".join(long_name.split()), None if needs == "-" else needs
    codes = _CODES.get(name, ())
    return Dataset(name, units, symbol, about, dtype=dtype, needs=feature, codes=codes, bits=name == "state")


GROUPS: Final = tuple(_groups())
JUNCTIONS, TRACE, SLIDER, LOAD, LANDMARKS, BALANCE, LIFE_CURVE, LIFE_TABLE = GROUPS


def motion_of(junctions: Container[str]) -> tuple[Feature]:
    """Return the feature (of a slider's motion) that names the columns of a run, from its columns of /junctions."""
    return ("free",) if "encounter" in junctions else ("two-way",)
