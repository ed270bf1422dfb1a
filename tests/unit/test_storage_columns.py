"""Columns read back from the disk, and the schema that names them."""

from rubnoise.record.rows import JunctionState
from rubnoise.simulation import pushing
from rubnoise.simulation.free.motion import CONTACT_LOST, CONTACT_MADE
from rubnoise.storage.schema import (
    GROUPS,
    JUNCTIONS,
    LANDMARKS,
    SLIDER,
)


def test_names_are_unique_and_texts_are_there() -> None:
    for group in GROUPS:
        names = [column.name for column in group.columns]
        assert len(set(names)) == len(names)
        assert group.plotted in names[1:]
        assert all(column.units and column.long_name and column.symbol for column in group.columns)


def test_every_column_has_the_unit_of_its_quantity() -> None:
    """Of what a column is, told by its symbol: a length in um is an area in um^2 when it is squared, and so on."""
    units = {
        "um": {"s", "s_birth", "s_death", "L_j", "d", "b", "x", "y", "z", "delta", "delta_max"},
        "um^2": {"A_r", "A_jmax"},
        "um/s": {"x'", "z'", "v_imp"},
        "s": {"t", "t_birth", "t_death", "t_stick"},
        "um*s": {"I_x"},
        "um^2*s": {"I_xx"},
        "um^2/s": {"I_vv"},
        "uN*um": {"W", "W_-"},
        "MPa": {"psi"},
        "uN": {"F_s", "F_-", "F_+", "P"},
        "1": {"i", "j", "state", "N_j", "u", "b/d", "a", "n", "phase", "kind"},
    }
    found: dict[str, set[str]] = {}
    for group in GROUPS:
        for column in group.columns:
            found.setdefault(column.units, set()).add(column.symbol)
    assert found == units


def test_values_are_those_of_the_motion() -> None:
    (phase,) = (column for column in SLIDER.columns if column.name == "phase")
    assert dict(phase.codes) == {pushing.SLIP: "slip", pushing.STUCK: "stick", pushing.REVERSED: "reversal"}
    (kind,) = (column for column in LANDMARKS.columns if column.name == "kind")
    assert dict(kind.codes) == {
        pushing.STICK: "stick", pushing.BREAKAWAY: "slip", pushing.REVERSAL: "reversal", pushing.FORWARD: "forward",
        CONTACT_LOST: "contact_lost", CONTACT_MADE: "contact_made",
    }  # fmt: skip


def test_flags_are_the_states_of_the_record() -> None:
    (state,) = (column for column in JUNCTIONS.columns if column.name == "state")
    assert dict(state.codes) == {member.value: (member.name or "").lower() for member in JunctionState if member.value}
