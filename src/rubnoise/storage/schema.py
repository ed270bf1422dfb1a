"""Every dataset of a result file, written once: name, type, unit and meaning. Data only."""

from collections.abc import Collection, Container
from dataclasses import dataclass, replace
from enum import IntEnum
from typing import Final, Literal

from rubnoise.record.rows import ContactKind, LandmarkKind, Phase

Feature = Literal["speed", "strength", "slider", "two-way", "offset", "load", "free", "base"]
"""What a scenario may add to the bare contact: times, forces, a slider, that it pushes back, passes off the
centre line, a load that weighs, that the slider may leave its contact, and a base that lifts it."""

Scalar = float | int | str
"""What an attribute holds."""

FORMAT: Final = "rubnoise-run"
FORMAT_VERSION: Final = 1
CONVENTIONS: Final = "CF-1.11"
CHUNK_ROWS: Final = 65_536  # in a chunk of a compressed column: a file with others is refused
HASH: Final = "xxh3_128"
HASH_DIGITS: Final = 32


@dataclass(frozen=True, slots=True, kw_only=True)
class Dataset:
    """One dataset of one dimension; ``needs`` names the feature without which it is absent.

    ``flags`` are the meanings of bits, ``values`` those of whole numbers. ``instead``: with a feature, what it is in
    words and what its values mean.
    """

    name: str
    units: str
    long_name: str
    symbol: str
    dtype: str = "<f8"
    needs: Feature | None = None
    flags: tuple[tuple[int, str], ...] = ()
    values: tuple[tuple[int, str], ...] = ()
    instead: tuple[tuple[Feature, str, tuple[tuple[int, str], ...]], ...] = ()

    def as_in(self, features: Collection[Feature]) -> "Dataset":
        """Return the column as it stands in a file with some features."""
        for feature, long_name, values in self.instead:
            if feature in features:
                return replace(self, long_name=long_name, values=values, instead=())
        return self

    @property
    def coded(self) -> tuple[str, tuple[tuple[int, str], ...]]:
        """The attribute of the CF conventions that lists its flags or values, and what each of them means."""
        return ("flag_values", self.values) if self.values else ("flag_masks", self.flags)


@dataclass(frozen=True, slots=True, kw_only=True)
class Group:
    """Columns of equal length; the first is their dimension scale, ``plotted`` the one that viewers draw against it.

    ``needs``: features of which it needs one; with none it is always there.
    ``grows``: features with which only the end of a run shows the number of its rows (see growing); all others are
    known before. ``added``: files of the same format version that were written earlier do not have it. ``lacks`` names
    features with which it is absent. ``instead``: with a feature, what it is in words, and what is plotted.
    """

    name: str
    long_name: str
    length: Literal["junctions", "ticks", "slider", "load", "landmarks", "balance", "blocks", "curve", "table"]
    columns: tuple[Dataset, ...]
    plotted: str
    needs: tuple[Feature, ...] = ()
    grows: tuple[Feature, ...] = ()
    added: bool = False
    lacks: tuple[Feature, ...] = ()
    instead: tuple[tuple[Feature, str, str], ...] = ()

    def as_in(self, features: Collection[Feature]) -> "Group":
        """Return it with its columns as a file with some features describes them."""
        said = next((words for feature, *words in self.instead if feature in features), (self.long_name, self.plotted))
        columns = tuple(column.as_in(features) for column in self.columns)
        return replace(self, long_name=said[0], plotted=said[1], columns=columns)


def _values(numbers: type[IntEnum]) -> tuple[tuple[int, str], ...]:
    return tuple((number.value, number.name.lower()) for number in numbers)


_TOUCHES: Final = "every touch of a summit, from contact made to contact lost, cut where the run begins and ends"

JUNCTIONS: Final = Group(
    name="junctions",
    long_name="whole life of every junction, in order of birth",
    length="junctions",
    plotted="diameter",
    grows=("free",),
    instead=(("free", _TOUCHES, "diameter"),),
    columns=(
        Dataset(name="junction", dtype="<i8", units="1", symbol="j", long_name="row number of the junction"),
        Dataset(
            name="encounter", dtype="<i8", units="1", symbol="i", long_name="number of the summit touched", needs="free"
        ),
        Dataset(name="birth_distance", units="um", symbol="s_birth", long_name="sliding distance at first touch"),
        Dataset(name="death_distance", units="um", symbol="s_death", long_name="sliding distance at separation"),
        Dataset(name="life_distance", units="um", symbol="L_j", long_name="sliding distance from birth to death"),
        Dataset(name="diameter", units="um", symbol="d", long_name="diameter of the two circles in contact"),
        Dataset(
            name="lateral_offset",
            units="um",
            symbol="b",
            long_name="distance of one circle's centre from the line of the other's, across the motion",
            needs="offset",
        ),
        Dataset(name="max_area", units="um^2", symbol="A_jmax", long_name="area at full overlap"),
        Dataset(
            name="max_overlap", units="um", symbol="delta_max", long_name="largest overlap in height", needs="free"
        ),
        Dataset(
            name="shear_strength",
            units="MPa",
            symbol="psi",
            long_name="shear strength of the junction",
            needs="strength",
        ),
        Dataset(name="birth_time", units="s", symbol="t_birth", long_name="time of first touch", needs="speed"),
        Dataset(name="death_time", units="s", symbol="t_death", long_name="time of separation", needs="speed"),
        Dataset(
            name="state",
            dtype="|u1",
            units="1",
            symbol="state",
            long_name="what cut the life short (0: nothing, the life is complete)",
            flags=((1, "alive_at_start"), (2, "alive_at_end"), (4, "ended_early")),
        ),
    ),
)

TRACE: Final = Group(
    name="trace",
    long_name="the contact at every tick of sliding distance",
    length="ticks",
    plotted="real_contact_area",
    columns=(
        Dataset(name="distance", units="um", symbol="s", long_name="sliding distance"),
        Dataset(name="real_contact_area", units="um^2", symbol="A_r", long_name="real contact area"),
        Dataset(name="junction_count", dtype="<u4", units="1", symbol="N_j", long_name="number of live junctions"),
        Dataset(name="friction_force", units="uN", symbol="F_s", long_name="friction force", needs="strength"),
    ),
)

SLIDER: Final = Group(
    name="slider",
    long_name="motion of the slider, uniform in time",
    length="slider",
    needs=("slider",),
    grows=("slider",),
    plotted="displacement",
    columns=(
        Dataset(name="time", units="s", symbol="t", long_name="time"),
        Dataset(name="distance", units="um", symbol="s", long_name="sliding distance"),
        Dataset(
            name="friction_force", units="uN", symbol="F_s", long_name="friction force on the slider", needs="strength"
        ),
        Dataset(name="base_displacement", units="um", symbol="y", long_name="height of the base", needs="base"),
        Dataset(name="displacement", units="um", symbol="x", long_name="displacement of the slider"),
        Dataset(name="velocity", units="um/s", symbol="x'", long_name="velocity of the slider"),
        Dataset(
            name="phase",
            dtype="|u1",
            units="1",
            symbol="phase",
            long_name="how the slider moves over the surface",
            needs="two-way",
            values=_values(Phase),
        ),
    ),
)

LOAD: Final = Group(
    name="load",
    long_name="the slider as it rises and falls under its load, to which both friction_force belong; /junctions,"
    " real_contact_area and junction_count are those at the mean separation",
    length="load",
    needs=("load",),
    plotted="separation",
    instead=(("free", "the slider as it rises and falls under its load, free to leave its contact", "separation"),),
    columns=(
        Dataset(name="time", units="s", symbol="t", long_name="time"),
        Dataset(
            name="separation",
            units="um",
            symbol="z",
            long_name="separation of the surfaces less its mean",
            instead=(("free", "separation of the surfaces less that at rest", ()),),
        ),
        Dataset(name="velocity", units="um/s", symbol="z'", long_name="normal velocity of the slider"),
        Dataset(name="load", units="uN", symbol="P", long_name="load that the junctions bear"),
        Dataset(
            name="live_overlap",
            units="um",
            symbol="delta",
            long_name="mean overlap of the live junctions in height; nan without live junctions",
        ),
    ),
)

LANDMARKS: Final = Group(
    name="landmarks",
    long_name="where the slider sticks, breaks away and turns round",
    length="landmarks",
    needs=("two-way", "free"),
    grows=("two-way", "free"),
    plotted="displacement",
    instead=(("free", "where the slider loses contact, and makes it again", "impact_speed"),),
    columns=(
        Dataset(name="landmark", dtype="<i8", units="1", symbol="n", long_name="row number of the landmark"),
        Dataset(name="time", units="s", symbol="t", long_name="time"),
        Dataset(name="distance", units="um", symbol="s", long_name="sliding distance"),
        Dataset(
            name="kind",
            dtype="|u1",
            units="1",
            symbol="kind",
            long_name="what the slider begins",
            values=_values(LandmarkKind) + _values(ContactKind),
            instead=(("two-way", "what the slider begins", _values(LandmarkKind)),),
        ),
        Dataset(
            name="impact_speed",
            units="um/s",
            symbol="v_imp",
            long_name="how fast the overlap grows where contact is made, and shrinks where it is lost",
            needs="free",
        ),
        Dataset(name="displacement", units="um", symbol="x", long_name="displacement of the slider", needs="slider"),
        Dataset(name="velocity", units="um/s", symbol="x'", long_name="velocity of the slider", needs="slider"),
        Dataset(
            name="force_before",
            units="uN",
            symbol="F_-",
            long_name="friction force on the slider just before",
            needs="two-way",
        ),
        Dataset(
            name="force_after",
            units="uN",
            symbol="F_+",
            long_name="friction force on the slider just after",
            needs="two-way",
        ),
    ),
)

BALANCE: Final = Group(
    name="balance",
    long_name="where a two-way run ends, and integrals over its whole motion",
    length="balance",
    needs=("two-way",),
    plotted="displacement",
    columns=(
        Dataset(name="time", units="s", symbol="t", long_name="time at the end of the run"),
        Dataset(name="distance", units="um", symbol="s", long_name="sliding distance at the end of the run"),
        Dataset(name="displacement", units="um", symbol="x", long_name="displacement of the slider at the end"),
        Dataset(name="velocity", units="um/s", symbol="x'", long_name="velocity of the slider at the end"),
        Dataset(name="time_stuck", units="s", symbol="t_stick", long_name="time that the slider has stuck"),
        Dataset(
            name="displacement_integral",
            units="um*s",
            symbol="I_x",
            long_name="integral of the displacement over time",
        ),
        Dataset(
            name="displacement_squared_integral",
            units="um^2*s",
            symbol="I_xx",
            long_name="integral of the squared displacement over time",
        ),
        Dataset(
            name="velocity_squared_integral",
            units="um^2/s",
            symbol="I_vv",
            long_name="integral of the squared velocity over time",
        ),
        Dataset(
            name="friction_work",
            units="uN*um",
            symbol="W",
            long_name="work of friction: integral of the force that the contact bears over the path",
        ),
        Dataset(
            name="reverse_work", units="uN*um", symbol="W_-", long_name="the part of friction_work done in reversals"
        ),
    ),
)

BLOCKS: Final = Group(
    name="blocks",
    long_name="where every block of the run begins, and what is carried into it beside junctions",
    length="blocks",
    added=True,
    plotted="birth_distance",
    instead=(("free", "where every stretch begins, and rows of /junctions known by then", "birth_distance"),),
    columns=(
        Dataset(name="block", dtype="<i8", units="1", symbol="k", long_name="number of the block"),
        Dataset(name="birth_distance", units="um", symbol="s_birth", long_name="first birth that belongs to the block"),
        Dataset(name="first_junction", dtype="<i8", units="1", symbol="j_0", long_name="junctions born before it"),
        Dataset(name="first_tick", dtype="<i8", units="1", symbol="i_0", long_name="ticks finished before it"),
        Dataset(
            name="time",
            units="s",
            symbol="t",
            long_name="time of the last row of /slider before the slider reaches it",
            needs="two-way",
        ),
        Dataset(
            name="distance",
            units="um",
            symbol="s",
            long_name="sliding distance in that row",
            needs="two-way",
        ),
        Dataset(
            name="phase",
            dtype="|u1",
            units="1",
            symbol="phase",
            long_name="how the slider moves over the surface in that row",
            needs="two-way",
            values=_values(Phase),
        ),
        Dataset(
            name="displacement",
            units="um",
            symbol="x",
            long_name="displacement of the slider at the last tick before it",
            needs="slider",
        ),
        Dataset(
            name="velocity",
            units="um/s",
            symbol="x'",
            long_name="velocity of the slider at the last tick before it",
            needs="slider",
            instead=(("base", "x' - c y/m at the last tick before it, y the height of the base", ()),),
        ),
        Dataset(
            name="separation",
            units="um",
            symbol="z",
            long_name="separation less its mean at the last tick before it",
            instead=(("free", "separation less that at rest at the last tick before it", ()),),
            needs="load",
        ),
        Dataset(
            name="separation_velocity",
            units="um/s",
            symbol="z'",
            long_name="normal velocity of the slider at the last tick before it",
            needs="load",
        ),
    ),
)

LIFE_CURVE: Final = Group(
    name="life_curve",
    long_name="area of any junction: diameter^2 * interp(u), u = (s - birth_distance)/diameter",
    length="curve",
    lacks=("offset", "free"),
    plotted="area_fraction",
    columns=(
        Dataset(name="u", units="1", symbol="u", long_name="sliding distance since birth over diameter"),
        Dataset(name="area_fraction", units="1", symbol="a", long_name="area of the junction over diameter squared"),
    ),
)

LIFE_TABLE: Final = Group(
    name="life_table",
    long_name="area of any junction: diameter^2 times what lies between the four rows around its u and offset_fraction",
    length="table",
    needs=("offset",),
    plotted="area_fraction",
    columns=(
        Dataset(
            name="u", units="1", symbol="u", long_name="sliding distance since birth over half of the life, from 0 to 2"
        ),
        Dataset(
            name="offset_fraction",
            units="1",
            symbol="b/d",
            long_name="size of the lateral offset over diameter, from 0 to 1 for each u",
        ),
        Dataset(name="area_fraction", units="1", symbol="a", long_name="area of the junction over diameter squared"),
    ),
)

GROUPS: Final = (JUNCTIONS, TRACE, SLIDER, LOAD, LANDMARKS, BALANCE, BLOCKS, LIFE_CURVE, LIFE_TABLE)


def motion_of(junctions: Container[str]) -> tuple[Feature]:
    """Return the feature whose words the columns of a run have, from the names of its columns of /junctions."""
    return ("free",) if "encounter" in junctions else ("two-way",)
