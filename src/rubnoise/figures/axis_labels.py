"""Labels on the axes of pictures for the figures of runs and the keys of scenarios."""

from rubnoise.figure_names import FIGURE_NAMES


def quantity_label(name: str) -> str:
    """Return the label of a figure's axis."""
    known = FIGURE_NAMES[name]
    return f"{known.words} ({shown_unit(known.unit)})" if known.unit else known.words


def quantity_words(name: str) -> str:
    """Return a figure in words, on one line."""
    return FIGURE_NAMES[name].words.replace("\n", " ")


def key_label(key: str, unit: str) -> str:
    """Return the label of a swept key's axis: its name in words, and the unit that its column has."""
    return f"{key_words(key)} ({shown_unit(unit)})" if unit not in {"", "1"} else key_words(key)


def key_words(key: str) -> str:
    """Return a key in words, with its table if the name needs it."""
    table, _, name = key.rpartition(".")
    words = name.replace("_", " ")
    return f"{table} {words}" if name in {"law", "spread", "mean", "start", "shape", "speed"} else words


def shown_unit(unit: str) -> str:
    """Return a unit in printed form."""
    return unit.replace("um", "µm").replace("uN", "µN").replace("^2", "²").replace("*", " ")
