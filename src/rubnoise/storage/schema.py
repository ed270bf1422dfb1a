"""Every dataset of a result file, written once: name, type, unit and meaning. Data only."""

from collections.abc import Collection, Container, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, replace
from enum import IntEnum
from types import UnionType
from typing import Any, Final, Literal

import numpy as np

from rubnoise.record.rows import ContactKind, LandmarkKind, Phase

Feature = Literal["speed", "strength", "slider", "two-way", "offset", "load", "free", "base"]
"""What a scenario may add to the bare contact: times, forces, a slider, that it pushes back, passes off the
centre line, a load that weighs, that the slider may leave its contact, and a base that lifts it."""

Scalar = float | int | str
"""What an attribute holds."""

FORMAT: Final = "rubnoise-run"
INDEX_FORMAT: Final = "rubnoise-sweep"
FORMAT_VERSION: Final = 2
CONVENTIONS: Final = "CF-1.11"
CHUNK_ROWS: Final = 65_536  # in a chunk of a compressed column: a file with others is refused
HASH: Final = "xxh3_128"
HASH_DIGITS: Final = 32

ROOT: Final[Mapping[str, type | UnionType]] = dict.fromkeys(
    ("Conventions", "format", "format_version", "title", "source", "junction_area_formula"), Scalar
)
"""The attributes of the root, and what each may hold; NX_class and default are for viewers."""

INTERVENTION: Final = "intervention"
"""What /provenance has only of a run whose lives were ended from outside: the name of the function."""

PROVENANCE: Final[Mapping[str, type | UnionType]] = {
    "scenario_toml": str,
    "scenario_resolved": str,
    "software": str,
    "environment": str,
    "propagator_constants": str,
    "command": str,
    "started": str,
    "finished": str,
    "seed": Scalar,
    "stream_version": Scalar,
    "calibrated_diameter": Scalar,
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


@dataclass(frozen=True, slots=True)
class Dataset:
    """One dataset of one dimension; ``needs`` names the feature without which it is absent.

    ``flags`` are the meanings of bits, ``values`` those of whole numbers. ``instead``: with a feature, what it is in
    words and what its values mean.
    """

    name: str
    units: str
    symbol: str
    long_name: str
    _: KW_ONLY
    dtype: str = "<f8"
    needs: Feature | None = None
    flags: tuple[tuple[int, str], ...] = ()
    values: tuple[tuple[int, str], ...] = ()
    instead: tuple[tuple[Feature, str, tuple[tuple[int, str], ...]], ...] = ()

    def as_in(self, features: Collection[Feature]) -> "Dataset":
        """Return the column as a file with these features describes it."""
        for feature, long_name, values in self.instead:
            if feature in features:
                return replace(self, long_name=long_name, values=values, instead=())
        return self

    @property
    def coded(self) -> tuple[str, tuple[tuple[int, str], ...]]:
        """The attributes of the CF conventions that list its flags or values, and their meanings."""
        return ("flag_values", self.values) if self.values else ("flag_masks", self.flags)

    @property
    def attributes(self) -> dict[str, Any]:
        """Unit, meaning and symbol by name, and what the CF conventions say of its flags or values."""
        said: dict[str, Any] = {"units": self.units, "long_name": self.long_name, "symbol": self.symbol}
        attribute, codes = self.coded
        if codes:
            said[attribute] = np.array([number for number, _ in codes], dtype=self.dtype)
            said["flag_meanings"] = " ".join(meaning for _, meaning in codes)
        return said


@dataclass(frozen=True, slots=True, kw_only=True)
class Group:
    """Columns of equal length; the first is their dimension scale, ``plotted`` the one that viewers draw against it.

    ``needs``: features of which it needs one; with none it is always there.
    ``lacks`` names features with which it is absent. ``instead``: with a feature, what it is in words, and what is
    plotted.
    """

    name: str
    long_name: str
    columns: tuple[Dataset, ...]
    plotted: str
    needs: tuple[Feature, ...] = ()
    lacks: tuple[Feature, ...] = ()
    instead: tuple[tuple[Feature, str, str], ...] = ()

    def as_in(self, features: Collection[Feature]) -> "Group":
        """Return the group with its columns as a file with these features describes them."""
        said = next((words for feature, *words in self.instead if feature in features), (self.long_name, self.plotted))
        columns = tuple(column.as_in(features) for column in self.columns)
        return replace(self, long_name=said[0], plotted=said[1], columns=columns)


def _values(numbers: type[IntEnum]) -> tuple[tuple[int, str], ...]:
    return tuple((number.value, number.name.lower()) for number in numbers)


_TOUCHES: Final = "every touch of a summit, from contact made to contact lost, cut where the run begins and ends"

JUNCTIONS: Final = Group(
    name="junctions",
    long_name="whole life of every junction, in order of birth",
    plotted="diameter",
    instead=(("free", _TOUCHES, "diameter"),),
    columns=(
        Dataset("junction", "1", "j", "row number of the junction", dtype="<i8"),
        Dataset("encounter", "1", "i", "number of the summit touched", dtype="<i8", needs="free"),
        Dataset("birth_distance", "um", "s_birth", "sliding distance at first touch"),
        Dataset("death_distance", "um", "s_death", "sliding distance at separation"),
        Dataset("life_distance", "um", "L_j", "sliding distance from birth to death"),
        Dataset("diameter", "um", "d", "diameter of the two circles in contact"),
        Dataset(
            "lateral_offset",
            "um",
            "b",
            "distance of one circle's centre from the line of the other's, across the motion",
            needs="offset",
        ),
        Dataset("max_area", "um^2", "A_jmax", "area at full overlap"),
        Dataset("max_overlap", "um", "delta_max", "largest overlap in height", needs="free"),
        Dataset("shear_strength", "MPa", "psi", "shear strength of the junction", needs="strength"),
        Dataset("birth_time", "s", "t_birth", "time of first touch", needs="speed"),
        Dataset("death_time", "s", "t_death", "time of separation", needs="speed"),
        Dataset(
            "state",
            "1",
            "state",
            "what cut the life short (0: nothing, the life is complete)",
            dtype="|u1",
            flags=((1, "alive_at_start"), (2, "alive_at_end"), (4, "ended_early")),
        ),
    ),
)

TRACE: Final = Group(
    name="trace",
    long_name="the contact at every tick of sliding distance",
    plotted="real_contact_area",
    columns=(
        Dataset("distance", "um", "s", "sliding distance"),
        Dataset("real_contact_area", "um^2", "A_r", "real contact area"),
        Dataset("junction_count", "1", "N_j", "number of live junctions", dtype="<u4"),
        Dataset("friction_force", "uN", "F_s", "friction force", needs="strength"),
    ),
)

_PHASE: Final = Dataset(
    "phase",
    "1",
    "phase",
    "how the slider moves over the surface",
    dtype="|u1",
    needs="two-way",
    values=_values(Phase),
)

SLIDER: Final = Group(
    name="slider",
    long_name="motion of the slider, uniform in time",
    needs=("slider",),
    plotted="displacement",
    columns=(
        Dataset("time", "s", "t", "time"),
        Dataset("distance", "um", "s", "sliding distance"),
        Dataset("friction_force", "uN", "F_s", "friction force on the slider", needs="strength"),
        Dataset("base_displacement", "um", "y", "height of the base", needs="base"),
        Dataset("displacement", "um", "x", "displacement of the slider"),
        Dataset("velocity", "um/s", "x'", "velocity of the slider"),
        _PHASE,
    ),
)

LOAD: Final = Group(
    name="load",
    long_name="the slider as it rises and falls under its load, to which both friction_force belong; /junctions,"
    " real_contact_area and junction_count are those at the mean separation",
    needs=("load",),
    plotted="separation",
    instead=(("free", "the slider as it rises and falls under its load, free to leave its contact", "separation"),),
    columns=(
        Dataset("time", "s", "t", "time"),
        Dataset(
            "separation",
            "um",
            "z",
            "separation of the surfaces less its mean",
            instead=(("free", "separation of the surfaces less that at rest", ()),),
        ),
        Dataset("velocity", "um/s", "z'", "normal velocity of the slider"),
        Dataset("load", "uN", "P", "load that the junctions bear"),
        Dataset(
            "live_overlap", "um", "delta", "mean overlap of the live junctions in height; nan without live junctions"
        ),
    ),
)

LANDMARKS: Final = Group(
    name="landmarks",
    long_name="where the slider sticks, breaks away and turns round",
    needs=("two-way", "free"),
    plotted="displacement",
    instead=(("free", "where the slider loses contact, and makes it again", "impact_speed"),),
    columns=(
        Dataset("landmark", "1", "n", "row number of the landmark", dtype="<i8"),
        Dataset("time", "s", "t", "time"),
        Dataset("distance", "um", "s", "sliding distance"),
        Dataset(
            "kind",
            "1",
            "kind",
            "what the slider begins",
            dtype="|u1",
            values=_values(LandmarkKind) + _values(ContactKind),
            instead=(("two-way", "what the slider begins", _values(LandmarkKind)),),
        ),
        Dataset(
            "impact_speed",
            "um/s",
            "v_imp",
            "how fast the overlap grows where contact is made, and shrinks where it is lost",
            needs="free",
        ),
        Dataset("displacement", "um", "x", "displacement of the slider", needs="slider"),
        Dataset("velocity", "um/s", "x'", "velocity of the slider", needs="slider"),
        Dataset("force_before", "uN", "F_-", "friction force on the slider just before", needs="two-way"),
        Dataset("force_after", "uN", "F_+", "friction force on the slider just after", needs="two-way"),
    ),
)

BALANCE: Final = Group(
    name="balance",
    long_name="where a two-way run ends, and integrals over its whole motion",
    needs=("two-way",),
    plotted="displacement",
    columns=(
        Dataset("time", "s", "t", "time at the end of the run"),
        Dataset("distance", "um", "s", "sliding distance at the end of the run"),
        Dataset("displacement", "um", "x", "displacement of the slider at the end"),
        Dataset("velocity", "um/s", "x'", "velocity of the slider at the end"),
        Dataset("time_stuck", "s", "t_stick", "time that the slider has stuck"),
        Dataset("displacement_integral", "um*s", "I_x", "integral of the displacement over time"),
        Dataset("displacement_squared_integral", "um^2*s", "I_xx", "integral of the squared displacement over time"),
        Dataset("velocity_squared_integral", "um^2/s", "I_vv", "integral of the squared velocity over time"),
        Dataset(
            "friction_work",
            "uN*um",
            "W",
            "work of friction: integral of the force that the contact bears over the path",
        ),
        Dataset("reverse_work", "uN*um", "W_-", "the part of friction_work done in reversals"),
    ),
)

LIFE_CURVE: Final = Group(
    name="life_curve",
    long_name="area of any junction: diameter^2 * interp(u), u = (s - birth_distance)/diameter",
    lacks=("offset", "free"),
    plotted="area_fraction",
    columns=(
        Dataset("u", "1", "u", "sliding distance since birth over diameter"),
        Dataset("area_fraction", "1", "a", "area of the junction over diameter squared"),
    ),
)

LIFE_TABLE: Final = Group(
    name="life_table",
    long_name="area of any junction: diameter^2 times what lies between the four rows around its u and offset_fraction",
    needs=("offset",),
    plotted="area_fraction",
    columns=(
        Dataset("u", "1", "u", "sliding distance since birth over half of the life, from 0 to 2"),
        Dataset("offset_fraction", "1", "b/d", "size of the lateral offset over diameter, from 0 to 1 for each u"),
        Dataset("area_fraction", "1", "a", "area of the junction over diameter squared"),
    ),
)

GROUPS: Final = (JUNCTIONS, TRACE, SLIDER, LOAD, LANDMARKS, BALANCE, LIFE_CURVE, LIFE_TABLE)


def motion_of(junctions: Container[str]) -> tuple[Feature]:
    """Return the feature (of a slider's motion) that names the columns of a run, from its columns of /junctions."""
    return ("free",) if "encounter" in junctions else ("two-way",)
