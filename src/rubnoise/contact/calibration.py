"""The three calibrations: the mean diameter from the mean real contact area and the mean junction count."""

from dataclasses import replace
from functools import lru_cache
from typing import Any

from rubnoise.contact.laws import Spread
from rubnoise.contact.pulses import LENS, Pulse
from rubnoise.errors import Refused

_DIGITS = 40
_PAPER_LIFE_MEAN = "0.327"  # Eq. 6 rounds 1/3 down; kept for the calibration that reproduces the paper
_TURNING = (0.3, 3.0)  # where E[d^3]/d_m is least for unit spread lies between: at 0.89 to 1.5 for the laws there are


class NoMatchingDiameter(Refused):
    """No mean diameter gives the wanted mean area with this absolute spread.

    ``minimum`` in um^2 is the least possible mean area, ``factor`` times N_jm spread^2.
    """

    def __init__(self, mean_area: float, minimum: float, factor: float) -> None:
        self.minimum = minimum
        self.factor = factor
        super().__init__(
            f"no mean diameter matches a mean real contact area of {mean_area:g} um^2 with this spread: "
            f"the least that can be had is {factor:.7g} N_jm spread^2 = {minimum:g} um^2"
        )


class PaperMeansLens(Refused):
    """The paper's calibration was requested with another pulse than the paper's."""

    def __init__(self, name: str) -> None:
        super().__init__(f"calibration paper (0.327 d^2, Eq. 6) is for the lens, not for the {name}")


def calibrated_diameter(
    calibration: str, mean_area: float, mean_count: float, spread: Spread, pulse: Pulse = LENS
) -> float:
    """Return d_m in um, so that N_jm junctions have together the mean real contact area A_rm.

    ``paper``: d_m = sqrt(A_rm / (0.327 N_jm)) (first Eq. 12), for the lens alone; ``exact``: with the pulse's own life
    mean, 1/3 for the lens; ``matched``: the larger root of N_jm life_mean E[d^3] / d_m = A_rm with the sizes as drawn.
    Raises PaperMeansLens, and NoMatchingDiameter if ``matched`` has no root. At 40 digits and rounded once.
    """
    import mpmath

    if calibration == "paper" and pulse.name != "lens":
        raise PaperMeansLens(pulse.name)
    with mpmath.workdps(_DIGITS):
        mean_junction_area = mpmath.mpf(mean_area) / mpmath.mpf(mean_count)
        if calibration == "paper":
            return float(mpmath.sqrt(mean_junction_area / mpmath.mpf(_PAPER_LIFE_MEAN)))
        wanted = mean_junction_area / pulse.life_mean()
        if calibration == "exact":
            return float(mpmath.sqrt(wanted))
        if not (spread.absolute and spread.entry.takes_spread):
            return float(mpmath.sqrt(wanted / spread.moment(mpmath.mpf(1), 3)))
        least = _least_third_moment(spread.law)[1]
        if wanted < least * mpmath.mpf(spread.absolute) ** 2:
            factor = pulse.life_mean() * least
            raise NoMatchingDiameter(mean_area, float(factor * mean_count * spread.absolute**2), float(factor))
        return float(_matched_diameter(wanted, spread))


def _matched_diameter(wanted: Any, spread: Spread) -> Any:
    """Return the larger d_m with E[d^3] / d_m as wanted for an absolute spread, an mpmath number in um^2."""
    import mpmath

    unit = replace(spread, absolute=1.0)
    std = mpmath.mpf(spread.absolute)
    turning, _ = _least_third_moment(spread.law)
    root = mpmath.findroot(
        lambda r: unit.moment(r, 3) / r - wanted / std**2,
        (turning, mpmath.sqrt(wanted) / std),
        solver="anderson",
        maxsteps=200,
        verify=False,
    )
    return root * std


@lru_cache(maxsize=16)
def _least_third_moment(law: str) -> tuple[Any, Any]:
    """Return the d_m at which E[d^3]/d_m is least for unit spread, and that least value.

    0.887855 and 3 * 1.609247 for the normal law, sqrt 2 and 27/4 for the lognormal, 2^(1/4) and 3 + 2 sqrt 2 for gamma.
    """
    import mpmath

    with mpmath.workdps(_DIGITS):

        def third_over_mean(r: Any) -> Any:
            return Spread(absolute=1.0, law=law).moment(r, 3) / r

        turning = mpmath.findroot(lambda r: mpmath.diff(third_over_mean, r), _TURNING, solver="anderson", verify=False)
        return turning, third_over_mean(turning)
