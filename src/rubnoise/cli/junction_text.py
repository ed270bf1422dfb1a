"""One junction's life as lines for a terminal or as a table."""

from collections.abc import Iterator
from pathlib import Path

from rubnoise.analysis.life import Life
from rubnoise.cli.layout import grouped, number, printable
from rubnoise.cli.terminal import filled, headed
from rubnoise.record.rows import JunctionState

UNITS = {"distance": "um", "time": "s", "area": "um^2", "force": "uN"}
STATES = {
    JunctionState.ALIVE_AT_START: "alive at the start",
    JunctionState.ALIVE_AT_END: "alive at the end",
    JunctionState.ENDED_EARLY: "ended early",
}
MOST_NAMED = 60
"""Others named on the terminal; --json names all."""


def state_names(state: JunctionState) -> list[str]:
    """Return the names of a state's bits as the file has them, ``complete`` where there are none."""
    return [str(bit.name).lower() for bit in STATES if bit in state] or ["complete"]


def curve_lines(life: Life) -> Iterator[str]:
    """Yield the curve as a table with commas, the units in its heading; every number reads back to the same bits."""
    curve = life.curve()
    yield ",".join(f"{name}_{UNITS[name].replace('^', '')}" for name in curve)
    for values in zip(*(column.tolist() for column in curve.values()), strict=True):
        yield ",".join(map(repr, values))


def described(life: Life, file: Path) -> Iterator[str]:
    """Yield the life in words and numbers."""
    state = ", ".join(words for bit, words in STATES.items() if bit in life.state) or "a complete life"
    yield f"{printable(str(file))}: junction {life.number} of 0 to {life.rows - 1}, {state}"
    yield ""
    yield from _course(life)
    yield ""
    yield _line("diameter", life.diameter, "um")
    yield _line("area at full overlap", life.max_area, "um^2")
    if life.shear_strength is not None:
        yield _line("shear strength", life.shear_strength, "MPa")
    yield ""
    yield from _peak(life)


def _course(life: Life) -> Iterator[str]:
    yield _event("birth", life, life.birth_distance)
    middle = life.mid_life_distance
    yield _event("mid-life", life, middle) if middle is not None else "  mid-life    not reached"
    yield _event("death", life, life.death_distance)
    length = _line("life", life.life_distance, "um")
    if life.birth_time is not None and life.death_time is not None:
        length = f"{length:<31}{number(life.death_time - life.birth_time):>14} s"
    yield length


def _event(name: str, life: Life, distance: float) -> str:
    time = life.time(distance)
    after = "" if time is None else f"{number(float(time)):>14} s"
    if distance < 0.0:
        after += "   before the start"
    elif distance > life.record_end:
        after += "   after the end"
    return headed(f"{_line(name, distance, 'um'):<31}", after)


def _line(name: str, value: float, unit: str, after: str = "") -> str:
    return headed(f"  {name:<22}{number(value):>13} {unit}", after)


def _peak(life: Life) -> Iterator[str]:
    yield f"at {_occasion(life)}, {number(life.peak_distance)} um"
    yield _line("its area", life.peak_area, "um^2", f"   {_percent(life.area_share)} of the contact")
    yield _line("real contact area", life.real_contact_area, "um^2")
    if life.peak_force is not None and life.friction_force is not None and life.force_share is not None:
        yield _line("its force", life.peak_force, "uN", f"   {_percent(life.force_share)} of the friction force")
        yield _line("friction force", life.friction_force, "uN")
    yield from _others(life)


def _occasion(life: Life) -> str:
    if life.peak_distance == life.mid_life_distance:
        return "its peak, mid-life"
    if life.peak_distance == life.death_distance:
        return "its peak, just before it was ended"
    return f"its largest in the record, at the {'end' if life.peak_distance == life.record_end else 'start'}"


def _percent(share: float) -> str:
    return f"{100.0 * share:.3g} %"


def _others(life: Life) -> Iterator[str]:
    rows = life.beside.rows
    yield f"  alive beside it: {grouped(rows.size)}" + (", row numbers" if rows.size else "")
    named = ", ".join(str(row) for row in rows[:MOST_NAMED].tolist())
    more = f" and {grouped(rows.size - MOST_NAMED)} more (--json names all)" if rows.size > MOST_NAMED else ""
    if rows.size:
        yield filled(named + more, "    ", "    ")
