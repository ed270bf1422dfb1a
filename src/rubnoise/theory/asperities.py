"""The static contact of a rough surface under a load (Greenwood and Williamson): real contact area and contacts."""

from dataclasses import dataclass
from functools import partial
from math import exp, gamma, inf, pi, sqrt
from typing import Any, Literal

from rubnoise.errors import Refused
from rubnoise.real_numbers import number_in
from rubnoise.units import AREA, DENSITY, FORCE, LENGTH, STRESS, Kind

_FARTHEST = 12.0  # separations over the height scale, to either side, among which a load is looked for


@dataclass(frozen=True, slots=True)
class RoughContact:
    """A static contact: separation in um, load in uN, real contact area in um^2, contacts, mean pressure in MPa.

    ``plasticity_index`` is (E*/H) sqrt(s/R), None without a hardness: contacts are elastic below 0.6, plastic above 1.
    """

    separation: float
    load: float
    real_contact_area: float
    junction_count: float
    mean_pressure: float
    plasticity_index: float | None

    def interface(self) -> str:
        """Return the table [interface] of a scenario with this area and count."""
        area, count = f"{self.real_contact_area:.9g} um^2", f"{self.junction_count:.9g}"
        return f'[interface]\nmean_real_contact_area = "{area}"\nmean_junction_count = {count}\n'


def height_integral(heights: str, power: float, separation: float) -> float:
    """Return F_n(h) = int_h^inf (t - h)^n phi(t) dt for heights of unit scale, n >= 0; exp(-h) n! if exponential.

    n! exp(-h^2/4) D_(-n-1)(h)/sqrt(2 pi) if Gaussian, D a parabolic cylinder function; error some 1e-9.
    Source: Greenwood and Williamson (1966), doi:10.1098/rspa.1966.0242, Eqs. 10 to 14.
    """
    if heights == "exponential":
        return exp(-separation) * gamma(power + 1.0)
    from scipy.special import pbdv

    cylinder = float(pbdv(-power - 1.0, separation)[0])
    return gamma(power + 1.0) * exp(-0.25 * separation**2) * cylinder / sqrt(2.0 * pi)


def greenwood_williamson(
    *,
    radius: Any,
    height: Any,
    density: Any,
    modulus: Any,
    load: Any = None,
    separation: Any = None,
    nominal_area: Any = "1 mm^2",
    hardness: Any = None,
    heights: Literal["gaussian", "exponential"] = "gaussian",
    regime: Literal["elastic", "plastic"] = "elastic",
) -> RoughContact:
    """Return the static contact of a rough surface with a smooth one, at a load or at a separation of mean planes.

    radius R, height scale s (standard deviation; of exponential heights the mean), density eta of asperities, modulus
    E* (of both, plane strain), as texts with units, quantities of pint, or numbers in um, 1/um^2, MPa, uN.
    With h the separation over s, n eta times the nominal area: N = n F_0(h), elastic A = pi n R s F_1(h),
    P = (4/3) n E* sqrt(R) s^1.5 F_1.5(h); plastic twice that area, and P = H A. It is static: sliding changes the
    contact. Raises Refused.
    Source: Greenwood and Williamson (1966), doi:10.1098/rspa.1966.0242.

    >>> import rubnoise
    >>> found = rubnoise.greenwood_williamson(
    ...     radius="50 um", height="0.5 um", density="300 1/mm^2", modulus="100 GPa", load="1 N"
    ... )
    >>> round(found.real_contact_area, 1), round(found.junction_count, 2)
    (294.8, 9.61)
    """
    if (load is None) == (separation is None):
        raise Refused("either a load or a separation")
    if regime == "plastic" and hardness is None:
        raise Refused("a plastic contact needs a hardness")
    if heights not in {"gaussian", "exponential"} or regime not in {"elastic", "plastic"}:
        raise Refused("heights are gaussian or exponential, and a regime elastic or plastic")
    r, s = _positive("radius", radius, LENGTH), _positive("height", height, LENGTH)
    count = _positive("density", density, DENSITY) * _positive("nominal area", nominal_area, AREA)
    stiff = _positive("modulus", modulus, STRESS)
    hard = inf if hardness is None else _positive("hardness", hardness, STRESS)
    plastic, integral = regime == "plastic", partial(height_integral, heights)

    def area_at(h: float) -> float:
        return (1.0 + plastic) * pi * count * r * s * integral(1.0, h)

    def load_at(h: float) -> float:
        return hard * area_at(h) if plastic else 4.0 / 3.0 * count * stiff * sqrt(r) * s**1.5 * integral(1.5, h)

    if load is None:
        h = number_in(separation, "separation", LENGTH) / s
    else:
        from scipy.optimize import brentq

        least = 0.0 if heights == "exponential" else -_FARTHEST
        wanted, fewest, most = _positive("load", load, FORCE), load_at(_FARTHEST), load_at(least)
        if not fewest <= wanted <= most:
            raise Refused(f"a load of {wanted:g} uN: this surface carries {fewest:.3g} to {most:.3g} uN")
        h = float(brentq(lambda h: load_at(h) - wanted, least, _FARTHEST, xtol=1e-14, rtol=1e-14))
    if heights == "exponential" and h < 0.0:
        raise Refused("exponential heights begin at the mean plane: the separation is not negative")
    if h < -_FARTHEST:
        raise Refused(f"separation: {h:g} heights below the mean plane, where {-_FARTHEST:g} is the least")
    area, force = area_at(h), load_at(h)
    pressure, plasticity = force / area if area else 0.0, None if hardness is None else stiff / hard * sqrt(s / r)
    return RoughContact(h * s, force, area, count * integral(0.0, h), pressure, plasticity)


def _positive(name: str, value: Any, kind: Kind) -> float:
    number = number_in(value, name, kind)
    if not 0.0 < number < inf:
        raise Refused(f"{name}: must be above 0")
    return number
