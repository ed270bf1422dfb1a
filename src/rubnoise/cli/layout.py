"""How figures are laid out on a terminal: a label, a value, a unit."""

from collections.abc import Iterable
from math import isfinite

from rubnoise.analysis.agreement import Agreement
from rubnoise.cli.terminal import filled, headed, width

LABEL_WIDTH, SHORTER_LABEL_WIDTH, NARROW = 30, 25, 72
"""Columns of labels before their values, and the same on terminals of fewer columns than the last."""

WORTH_A_WARNING = 0.1
"""Spread of the slider's velocity over the sliding speed from which one-way coupling is in doubt."""

UNITS = {
    "real_contact_area": "um^2",
    "junction_count": "",
    "friction_force": "uN",
    "displacement": "um",
    "velocity": "um/s",
    "mean_force": "uN",
}


def line(label: str, value: str, *, whole: bool = False) -> str:
    """Return one labelled value, indented below its heading; a long one on several lines unless it is kept whole."""
    head = f"  {label:<{LABEL_WIDTH if width() >= NARROW else SHORTER_LABEL_WIDTH}}"
    return head + printable(value) if whole else filled(printable(value), head, " " * len(head)) or head.rstrip()


def remark(text: str) -> str:
    """Return a sentence below the values."""
    return filled(text, "  ", "    ")


def printable(text: str) -> str:
    """Return a text from a file with whatever would steer a terminal escaped."""
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text)


def number(value: float) -> str:
    """Return a number to seven digits."""
    return f"{value:.7g}"


def grouped(value: float) -> str:
    """Return a whole number with its thousands apart."""
    return f"{round(value):,}" if isfinite(value) else str(value)


def about(value: float) -> str:
    """Return a whole number that is an estimate, to three digits."""
    return f"about {grouped(float(f'{value:.3g}'))}"


def size(count: float) -> str:
    """Return a number of bytes in the unit that suits it."""
    for unit in ("B", "kB", "MB", "GB"):
        if count < 999.5:
            return f"{count:.3g} {unit}"
        count /= 1000.0
    return f"{count:.3g} TB"


def distance(um: float) -> str:
    """Return a sliding distance that is an estimate, to two digits, in the unit that suits it."""
    for unit, length in (("m", 1e6), ("mm", 1e3)):
        if um >= length:
            return f"{_two_digits(um / length)} {unit}"
    return f"{_two_digits(um)} um"


def duration(seconds: float) -> str:
    """Return a time that is an estimate, to two digits, in the unit that suits it."""
    for unit, length in (("h", 3600.0), ("min", 60.0)):
        if seconds >= 2.0 * length:
            return f"about {_two_digits(seconds / length)} {unit}"
    return f"about {_two_digits(seconds)} s"


def _two_digits(value: float) -> str:
    return f"{float(f'{value:.2g}'):,.10g}"


def one_way_warning(validity: float) -> str:
    """Return what a spread of the slider's velocity beside the sliding speed means for one-way coupling."""
    return (
        f"the velocity of the slider spreads by {validity:.3g} times the sliding speed,"
        " which one-way coupling takes for constant; two-way coupling"
        f' (slider.coupling = "two-way") is needed above {WORTH_A_WARNING:g}'
    )


ONE_WAY_ALONE = (
    "the slider pushes back: its displacement and velocity here are those of one-way coupling; a run shows the others"
)
"""What to say beside the exact motion of a slider that is coupled two ways."""


def too_short_for_motion(decays: float, needed: float) -> str:
    """Return what a run lacks for standard errors of its slider's motion, and what sliding distance it needs."""
    return (
        f"the run is too short for standard errors of the slider's motion: it lasts {decays:.2g} of its decay times;"
        f" it needs about {distance(needed)}"
    )


def agreement_table(figures: Iterable[Agreement]) -> list[str]:
    """Return a table of measured beside exact figures, with z-scores where there are any."""
    heading = headed(f"  {'':<33}", f"{'measured':>13}{'exact':>14}{'std error':>11}{'z':>7}")
    return [heading, *map(_row, figures)]


def _row(figure: Agreement) -> str:
    unit = "" if figure.name.endswith(("skewness", "kurtosis")) else _unit(figure.name)
    label = printable(figure.name).replace("one_way", "one-way").replace("_", " ") + (f" ({unit})" if unit else "")
    expected = "" if figure.expected is None else number(figure.expected)
    error = "" if figure.standard_error is None else f"{figure.standard_error:.3g}"
    z = "" if figure.z is None else f"{figure.z:+.2f}"
    return headed(f"  {label:<33}", f"{number(figure.observed):>13}{expected:>14}{error:>11}{z:>7}")


def _unit(name: str) -> str:
    return next((unit for quantity, unit in UNITS.items() if name.startswith(quantity)), "")
