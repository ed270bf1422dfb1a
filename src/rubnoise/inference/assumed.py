"""The assumptions about junctions that a trace cannot show; every answer names them."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf, isinf, pi
from typing import Final

from rubnoise.contact.pulses import LENS, Pulse
from rubnoise.inference.estimates import Estimate
from rubnoise.inference.scoring import Fit, Given
from rubnoise.inference.sensor import Sensor
from rubnoise.inference.signal import Signal

SPREADS: Final = (0.0, 0.25, 0.5, 1.0)
"""Relative spreads of strengths for which number and strength are given beside the assumed one."""
ENOUGH_CYCLES: Final = 40.0
"""Cycles per life that a sensor has to pass if its filter is not given; docs/inference.md has the measured table."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Assumed:
    """The assumptions of an inference.

    ``strength_spread`` is the standard deviation over the mean of lognormal strengths, ``pulse`` the pulse of a
    junction's area, ``shape_chosen`` whether an option chose its shape, ``bandwidth`` the corner of each of the
    sensor's ``poles`` in cycles per um.
    """

    strength_spread: float = 0.0
    pulse: Pulse = LENS
    shape_chosen: bool = True
    bandwidth: float = inf
    poles: int = 1

    def sensor(self, tick: float) -> Sensor:
        """Return the filter of the sensor for samples every ``tick`` um."""
        return Sensor(corner=2.0 * pi * self.bandwidth * tick, poles=self.poles)

    @property
    def inequality(self) -> float:
        """E[psi^2] / E[psi]^2 = 1 + v, v the squared relative spread."""
        return 1.0 + self.strength_spread**2


NOTHING: Final = Assumed()
"""Equal strengths, passes through both centres, a sensor that passes everything."""


@dataclass(frozen=True, slots=True, kw_only=True)
class OtherPulse:
    """A pulse that was not assumed: the difference of its criterion, with its error, and the diameter that it gives.

    ``diameter`` is in um; ``diameter_off`` is its relative difference to that of the assumed pulse. ``told_apart`` is
    whether the deviances differ by more than 4 and by more than twice the error, either way; ``estimates`` are those
    that this pulse gives, ``furthest`` the largest relative difference of number, diameter, area and strength.
    """

    pulse: Pulse
    worse_by: float
    error: float
    diameter: float
    diameter_off: float
    told_apart: bool
    estimates: Mapping[str, Estimate]
    furthest: float


@dataclass(frozen=True, slots=True, kw_only=True)
class IfSpread:
    """Junction count and shear strength (MPa, if known) for another relative spread of strengths."""

    strength_spread: float
    junction_count: float
    shear_strength: float | None


def moves_with_spread(known: Given) -> bool:
    """Return whether an estimate depends on the spread of strengths, which has no estimate itself."""
    return "inequality" not in known.free and known.free != ("strength",)


def by_spread(estimates: Mapping[str, Estimate], known: Given) -> tuple[IfSpread, ...]:
    """Return how number and strength depend on the spread of strengths; empty if they do not.

    Mean and spectrum give A = lam E[psi] and B = lam E[psi^2]: the strength is B / (A (1 + v)), the number goes as
    A^2 (1 + v) / B. With a known strength and no mean the number goes as B / (psi^2 (1 + v)).
    """
    if not moves_with_spread(known) or "junction_count" not in estimates:
        return ()
    strength = estimates.get("shear_strength")
    found = []
    for spread in SPREADS:
        more = (1.0 + spread**2) / known.inequality
        count = estimates["junction_count"].value
        found.append(
            IfSpread(
                strength_spread=spread,
                junction_count=count * more if known.mean is not None else count / more,
                shear_strength=None if strength is None else strength.value / more,
            )
        )
    return tuple(found)


def assumptions(assumed: Assumed, fit: Fit, signal: Signal) -> dict[str, str]:
    """Return the assumptions by what they are about, one sentence each."""
    said = {}
    if moves_with_spread(fit.known) and not signal.is_area:
        said["strengths"] = (
            f"taken for lognormal with a spread of {100.0 * assumed.strength_spread:.3g} % of their mean"
            if assumed.strength_spread
            else "junctions are taken for equally strong (strength_spread= gives another spread)"
        )
    said["sensor"] = _of_sensor(assumed, 2.0 * fit.contact.place.diameter * signal.tick)
    shape = f"taken to have the shape {assumed.pulse.shape}"
    said["lives"] = shape if assumed.shape_chosen else f"{shape} (pulse= takes lens or parabola)"
    said["passes"] = (
        'taken to go through both centres (offset="uniform" for passes off it)'
        if assumed.pulse.offset == "none"
        else "taken to miss the centre by offsets uniform on -d to d"
    )
    if min(signal.ways) > 0:
        said["strokes"] = "each is taken to meet junctions of its own; where strokes repeat them, errors are larger"
    return said


def _of_sensor(assumed: Assumed, life: float) -> str:
    """Return the assumption about the sensor, for a mean ``life`` of 2 d in um."""
    if isinf(assumed.bandwidth):
        return f"taken to pass {ENOUGH_CYCLES:g} cycles per life or more (bandwidth= gives its corner)"
    poles = "one pole" if assumed.poles == 1 else f"{assumed.poles} poles"
    return f"taken to have {poles} at {assumed.bandwidth * life:.3g} cycles per life, 2 d"
