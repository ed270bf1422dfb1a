"""From mean real contact area and mean junction count to the mean diameter: the three calibrations."""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from rubnoise.contact.sizes import FixedSizes, NormalSizes, SizeLaw, positive_normal_moment
from rubnoise.errors import Refused

CALIBRATIONS = ("paper", "exact", "matched")
_DIGITS = 40
_PAPER_LIFE_MEAN = "0.327"  # Eq. 6 rounds 1/3 down; kept for the calibration that reproduces the paper


class NoMatchingDiameter(Refused):
    """No mean diameter gives the wanted mean area with this absolute spread; ``minimum`` in um^2 is the least."""

    def __init__(self, mean_area: float, minimum: float) -> None:
        self.minimum = minimum
        super().__init__(
            f"no mean diameter matches a mean real contact area of {mean_area:g} um^2 with this spread: "
            f"the least that can be had is 1.609247 N_jm spread^2 = {minimum:g} um^2"
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Spread:
    """Standard deviation of the normal law before redrawing: a length in um, or a fraction of the mean diameter."""

    absolute: float | None = None
    relative: float | None = None

    def std(self, mean_diameter: float) -> float:
        """Return the standard deviation in um for a mean diameter in um."""
        if self.relative is not None:
            return self.relative * mean_diameter
        return self.absolute or 0.0


def sizes_for(mean_diameter: float, spread: Spread) -> SizeLaw:
    """Return the size law of a mean diameter and a spread; no spread is one size."""
    std = spread.std(mean_diameter)
    return NormalSizes(mean=mean_diameter, std=std) if std > 0.0 else FixedSizes(diameter=mean_diameter)


def calibrated_diameter(calibration: str, mean_area: float, mean_count: float, spread: Spread) -> float:
    """Return d_m in um, so that N_jm junctions have the mean real contact area A_rm between them.

    ``paper``: d_m = sqrt(A_rm / (0.327 N_jm)) (first Eq. 12); ``exact``: with 1/3, the lens's own life mean;
    ``matched``: the larger root of (N_jm / 3) E[d^3] / d_m = A_rm with the size law as drawn.
    Raises NoMatchingDiameter where ``matched`` has no root. Computed at 40 digits and rounded once.
    """
    import mpmath

    with mpmath.workdps(_DIGITS):
        mean_junction_area = mpmath.mpf(mean_area) / mpmath.mpf(mean_count)
        if calibration == "paper":
            return float(mpmath.sqrt(mean_junction_area / mpmath.mpf(_PAPER_LIFE_MEAN)))
        if calibration == "exact":
            return float(mpmath.sqrt(3 * mean_junction_area))
        return _matched_diameter(mean_area, mean_count, spread)


def _matched_diameter(mean_area: float, mean_count: float, spread: Spread) -> float:
    import mpmath

    with mpmath.workdps(_DIGITS):
        wanted = 3 * mpmath.mpf(mean_area) / mpmath.mpf(mean_count)
        if spread.relative:
            third = positive_normal_moment(mpmath.mpf(1), mpmath.mpf(spread.relative), 3)
            return float(mpmath.sqrt(wanted / third))
        if not spread.absolute:
            return float(mpmath.sqrt(wanted))
        std = mpmath.mpf(spread.absolute)
        turning, least = _least_third_moment()
        if wanted < least * std**2:
            raise NoMatchingDiameter(mean_area, float(least * std**2 * mean_count / 3))
        root = mpmath.findroot(
            lambda r: positive_normal_moment(r, mpmath.mpf(1), 3) / r - wanted / std**2,
            (turning, mpmath.sqrt(wanted) / std),
            solver="anderson",
            maxsteps=200,
            verify=False,
        )
        return float(root * std)


@lru_cache(maxsize=1)
def _least_third_moment() -> tuple[Any, Any]:
    """Return where E[d^3]/d_m is least for unit spread, and its value there (0.887855 and 3 * 1.609247)."""
    import mpmath

    with mpmath.workdps(_DIGITS):

        def third_over_mean(r: Any) -> Any:
            return positive_normal_moment(r, mpmath.mpf(1), 3) / r

        turning = mpmath.findroot(lambda r: mpmath.diff(third_over_mean, r), mpmath.mpf("0.89"))
        return turning, third_over_mean(turning)
