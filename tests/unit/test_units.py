"""Quantities: the number is read exactly and strictly, the unit from a table that is equal to pint's."""

import re
from fractions import Fraction

import pint
import pytest

from rubnoise.units import (
    AREA,
    DAMPING,
    KINDS,
    LENGTH,
    MASS,
    RATIO,
    RATIOS,
    SPEED,
    STIFFNESS,
    STRESS,
    TIME,
    UNITS,
    USUAL_UNITS,
    Kind,
    QuantityError,
    Unit,
    parse_unit,
    read_quantity,
)
from tests.architecture.sources import ROOT

REGISTRY = pint.UnitRegistry(non_int_type=Fraction)


@pytest.mark.parametrize("name", USUAL_UNITS)
def test_the_table_of_usual_units_is_equal_to_pint(name: str) -> None:
    units = REGISTRY.parse_units(name)
    size, _ = REGISTRY.get_base_units(units)
    powers = tuple(int(units.dimensionality.get(d, 0)) for d in ("[length]", "[mass]", "[time]"))
    assert USUAL_UNITS[name].dimension == powers
    assert USUAL_UNITS[name].size == Fraction(size) * Fraction(10**6) ** powers[0]
    assert all(d in {"[length]", "[mass]", "[time]"} for d in units.dimensionality)


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_working_unit_and_example_of_a_kind_are_of_that_kind(kind: Kind) -> None:
    assert USUAL_UNITS[kind.unit].size == (Fraction(1, 100) if kind is RATIO else 1)
    assert read_quantity(kind.example, kind).kind is kind


@pytest.mark.parametrize(
    ("text", "kind", "exact"),
    [
        ("200 um^2", AREA, Fraction(200)),
        ("200 \u00b5m^2", AREA, Fraction(200)),
        ("200 \u03bcm**2", AREA, Fraction(200)),
        ("2e-4 mm^2", AREA, Fraction(200)),
        ("1 mm/s", SPEED, Fraction(1000)),
        ("1 mm / s", SPEED, Fraction(1000)),
        ("5 s^-1 m", SPEED, Fraction(5_000_000)),
        ("5 g", MASS, Fraction(1, 200)),
        ("250 MPa", STRESS, Fraction(250)),
        ("1 N/mm^2", STRESS, Fraction(1)),
        ("300 N/m", STIFFNESS, Fraction(300)),
        ("0.05 N*s/m", DAMPING, Fraction(1, 20)),
        ("0.05 kg/s", DAMPING, Fraction(1, 20)),
        ("1 inch", LENGTH, Fraction(25_400)),
        ("1 lbf/inch", STIFFNESS, Fraction(8896443230521, 50_800_000_000)),
        ("+1.5e+3 um", LENGTH, Fraction(1500)),
        (" 0.1 um ", LENGTH, Fraction(1, 10)),
        ("20 %", RATIO, Fraction(1, 5)),
        ("20%", RATIO, Fraction(1, 5)),
        ("5mm", LENGTH, Fraction(5000)),
        ("1e3um", LENGTH, Fraction(1000)),
        ("200um^2", AREA, Fraction(200)),
        ("0.05N*s/m", DAMPING, Fraction(1, 20)),
    ],
)
def test_a_quantity_is_converted_exactly_and_rounded_once(text: str, kind: Kind, exact: Fraction) -> None:
    quantity = read_quantity(text, kind)
    assert quantity.exact == exact
    assert float(quantity) == float(exact)
    assert quantity.written == text


TENS = {
    **dict(zip(("", "f", "p", "n", "u", "\u00b5", "\u03bc", "m"), (0, -15, -12, -9, -6, -6, -6, -3), strict=True)),
    **dict(zip(("c", "d", "da", "h", "k", "M", "G", "T"), (-2, -1, 1, 2, 3, 6, 9, 12), strict=True)),
    **dict(zip(("femto", "pico", "nano", "micro", "milli", "centi"), (-15, -12, -9, -6, -3, -2), strict=True)),
    **dict(zip(("deci", "hecto", "kilo", "mega", "giga", "tera"), (-1, 2, 3, 6, 9, 12), strict=True)),
}
"""The powers of ten of the prefixes, as the brochure of the SI has them."""

FORCE, PRESSURE = (1, 1, -2), (-1, 1, -2)
POUND, STANDARD_GRAVITY, INCH = Fraction("0.45359237"), Fraction("9.80665"), Fraction("0.0254")
IN_SI: dict[str, tuple[Fraction | int, tuple[int, int, int]]] = {
    **dict.fromkeys(("m", "meter", "metre", "meters", "metres"), (1, LENGTH.dimension)),
    **dict.fromkeys(("g", "gram", "grams"), (Fraction("1e-3"), MASS.dimension)),
    **dict.fromkeys(("s", "sec", "second", "seconds"), (1, TIME.dimension)),
    **dict.fromkeys(("N", "newton", "newtons"), (1, FORCE)),
    **dict.fromkeys(("Pa", "pascal", "pascals"), (1, PRESSURE)),
    **dict.fromkeys(("in", "inch"), (INCH, LENGTH.dimension)),
    **dict.fromkeys(("ft", "foot", "feet"), (12 * INCH, LENGTH.dimension)),
    "thou": (INCH / 1000, LENGTH.dimension),
    "yard": (36 * INCH, LENGTH.dimension),
    "mile": (63_360 * INCH, LENGTH.dimension),
    "micron": (Fraction("1e-6"), LENGTH.dimension),
    "angstrom": (Fraction("1e-10"), LENGTH.dimension),
    **dict.fromkeys(("min", "minute"), (60, TIME.dimension)),
    **dict.fromkeys(("h", "hr", "hour"), (3600, TIME.dimension)),
    "day": (86_400, TIME.dimension),
    **dict.fromkeys(("t", "tonne"), (1000, MASS.dimension)),
    **dict.fromkeys(("lb", "pound"), (POUND, MASS.dimension)),
    **dict.fromkeys(("oz", "ounce"), (POUND / 16, MASS.dimension)),
    "lbf": (POUND * STANDARD_GRAVITY, FORCE),
    "kgf": (STANDARD_GRAVITY, FORCE),
    "gf": (STANDARD_GRAVITY / 1000, FORCE),
    **dict.fromkeys(("dyn", "dyne"), (Fraction("1e-5"), FORCE)),
    "bar": (10**5, PRESSURE),
    "mbar": (10**2, PRESSURE),
    "kbar": (10**8, PRESSURE),
    "atm": (101_325, PRESSURE),
    "psi": (POUND * STANDARD_GRAVITY / INCH**2, PRESSURE),
    "ksi": (1000 * POUND * STANDARD_GRAVITY / INCH**2, PRESSURE),
}
"""Sizes in m, kg and s: of the SI, of the international yard and pound of 1959, and of those defined by them."""


WORDS = {
    name for name, (size, _) in IN_SI.items() if size in (1, Fraction("1e-3")) and len(name) > 3 and name != "inch"
}
"""Units of the SI in words."""


def _in_si(name: str) -> tuple[Fraction, tuple[int, int, int]]:
    """Return what a name stands for; where it can be taken apart in several ways, all have to say the same."""
    found = {
        (Fraction(10) ** TENS[name[:cut]] * IN_SI[name[cut:]][0], IN_SI[name[cut:]][1])
        for cut in range(len(name))
        if name[:cut] in TENS and name[cut:] in IN_SI and (not cut or name[cut:] in WORDS | {"m", "g", "s", "N", "Pa"})
    }
    (meant,) = found
    return meant


def test_every_name_of_a_unit_means_what_it_says() -> None:
    for name in UNITS.keys() - {*RATIOS}:
        size, dimension = _in_si(name)
        assert parse_unit(name) == Unit(size * Fraction(10**6) ** dimension[0], dimension), name
        assert read_quantity(f"1 um*{name}/{name}", LENGTH) == 1.0


UNKNOWN = """
    bit byte count radian rad degree turn steradian dB Np pi dimensionless mol permille pixel dot V K degC delta baud Hz
    J W l c e strain mil kt kn pa Mpa Kim kibim kinch kmin Mft kkg mmm ym qm as bohr u
"""


@pytest.mark.parametrize("name", UNKNOWN.split())
def test_a_unit_that_pint_knows_is_not_for_that_one_of_a_scenario(name: str) -> None:
    with pytest.raises(QuantityError, match=f'unknown unit "{name}"'):
        read_quantity(f"200 um^2*{name}", AREA)
    with pytest.raises(QuantityError, match=f'unknown unit "{name}"'):
        read_quantity(f"200 um^2 {name}/{name}", AREA)


def test_one_of_several_kinds_is_taken_and_else_all_are_named() -> None:
    assert read_quantity("20 %", LENGTH, RATIO).kind is RATIO
    assert read_quantity("2 um", LENGTH, RATIO).kind is LENGTH
    with pytest.raises(QuantityError, match=r'"s" is the unit of a time, a length or a ratio is needed'):
        read_quantity("2 s", LENGTH, RATIO)


def test_a_quantity_reads_back_to_the_same_exact_value() -> None:
    for text in ("0.1 um", "1 inch", "3.3e-7 m", "20 %", "12345678.000000001 mm"):
        kind = RATIO if "%" in text else LENGTH
        quantity = read_quantity(text, kind)
        assert read_quantity(quantity.as_text(), kind).exact == quantity.exact


def test_the_page_on_scenarios_names_every_unit() -> None:
    page = (ROOT / "docs" / "scenarios.md").read_text(encoding="utf-8")
    told = page.partition("**A unit consists of")[2].partition("\n- ")[0]
    assert IN_SI.keys() - WORDS | {*RATIOS} <= set(re.findall(r"[A-Za-z]+|%", told))
