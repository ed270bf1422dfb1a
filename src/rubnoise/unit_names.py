"""Which names may stand in a unit: those of lengths, times, masses, forces and pressures; and those of a ratio, alone.

Not whatever pint knows. To pint a bit, a count and a radian are 1, so that an area may hold one; pa is a picoyear, kt a
knot, and Kim 1024 m.
"""

_SI = ("m", "g", "s", "N", "Pa")
_PREFIXES = ("", "f", "p", "n", "u", "\u00b5", "\u03bc", "m", "c", "d", "da", "h", "k", "M", "G", "T")
_SI_WORDS = tuple(word + end for word in ("meter", "metre", "gram", "second", "newton", "pascal") for end in ("", "s"))
_PREFIX_WORDS = (
    "",
    "femto",
    "pico",
    "nano",
    "micro",
    "milli",
    "centi",
    "deci",
    "hecto",
    "kilo",
    "mega",
    "giga",
    "tera",
)

OTHERS = (
    *("micron", "angstrom", "thou", "in", "inch", "ft", "foot", "feet", "yard", "mile"),
    *("sec", "min", "minute", "h", "hr", "hour", "day", "t", "tonne", "oz", "ounce", "lb", "pound"),
    *("lbf", "kgf", "dyn", "dyne", "bar", "mbar", "kbar", "atm", "psi", "ksi"),
)
"""Those beside the SI, which take no prefixes."""

UNITS: frozenset[str] = frozenset(
    (
        *(prefix + unit for prefix in _PREFIXES for unit in _SI),
        *(prefix + unit for prefix in _PREFIX_WORDS for unit in _SI_WORDS),
        *OTHERS,
    )
)
RATIOS = ("%", "percent", "ppm")


def like(name: str) -> str:
    """Return advice on a name that is none: MPa for Mpa, and else what there is."""
    meant = sorted(known for known in UNITS if known.casefold() == name.casefold())
    quoted = " or ".join(f'"{known}"' for known in meant)
    return f"did you mean {quoted}?" if meant else "a length, time, mass, force or pressure, such as um, s, kg, N, MPa"
