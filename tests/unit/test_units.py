"""Quantities: the number is read exactly and strictly, the unit from a table that is equal to pint's."""

import re
from fractions import Fraction

import pint
import pytest

from rubnoise.units import _OTHERS as OTHERS
from rubnoise.units import (
    AREA,
    DAMPING,
    KINDS,
    LENGTH,
    MASS,
    RATIO,
    SPEED,
    STIFFNESS,
    STRESS,
    UNITS,
    USUAL_UNITS,
    Kind,
    QuantityError,
    Unit,
    read_quantity,
)
from tests.architecture.sources import ROOT

REGISTRY = pint.UnitRegistry(non_int_type=Fraction)


@pytest.mark.parametrize("name", {**UNITS, **USUAL_UNITS})
def test_the_table_of_usual_units_is_equal_to_pint(name: str) -> None:
    units = REGISTRY.parse_units(name)
    size, _ = REGISTRY.get_base_units(units)
    powers = tuple(int(units.dimensionality.get(d, 0)) for d in ("[length]", "[mass]", "[time]"))
    ours = USUAL_UNITS.get(name) or UNITS[name]
    assert ours == Unit(Fraction(size) * Fraction(10**6) ** powers[0], powers)
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
    plain = {name for names in OTHERS.values() for each in names.split(",") for name in each.split()[:-1]}
    assert plain | {"m", "g", "s", "N", "Pa"} <= set(re.findall(r"[A-Za-z]+|%", told))
