"""The three calibrations: the mean diameter from the mean real contact area and the mean junction count."""

from functools import lru_cache
from math import sqrt

from rubnoise.contact.laws import Spread, law_for
from rubnoise.contact.pulses import LENS, Pulse
from rubnoise.errors import Refused

_PAPER_LIFE_MEAN = 0.327  # Eq. 6 rounds 1/3 down; kept for the calibration that reproduces the paper
_TURNING = (0.3, 3.0)  # where E[d^3]/d_m is least for unit spread lies between: at 0.89 to 1.5 for the laws there are


class Uncalibrated(Refused):
    """No mean diameter gives the wanted mean area; ``key`` of [interface] may change, as ``hint`` says."""

    def __init__(self, key: str, message: str, hint: str) -> None:
        self.key, self.hint = key, hint
        super().__init__(message)


def calibrated_diameter(
    calibration: str, mean_area: float, mean_count: float, spread: Spread, pulse: Pulse = LENS
) -> float:
    """Return d_m in um, so that N_jm junctions have together the mean real contact area A_rm.

    ``paper``: d_m = sqrt(A_rm / (0.327 N_jm)) (first Eq. 12), for the lens alone; ``exact``: with the pulse's own life
    mean, 1/3 for the lens; ``matched``: the larger root of N_jm life_mean E[d^3] / d_m = A_rm with the sizes as drawn.
    Raises Uncalibrated for ``paper`` with another pulse, and if ``matched`` has no root.
    """
    if calibration == "paper":
        if pulse.name != "lens":
            message = f"calibration paper (0.327 d^2, Eq. 6) is for the lens, not for the {pulse.name}"
            raise Uncalibrated("calibration", message, 'calibration = "exact" or "matched"')
        return sqrt(mean_area / (mean_count * _PAPER_LIFE_MEAN))
    wanted = mean_area / (mean_count * pulse.life_mean())
    if calibration == "exact":
        return sqrt(wanted)
    if not (spread.absolute and spread.entry.takes_spread):
        return sqrt(mean_area / (mean_count * pulse.life_mean() * law_for(1.0, spread).moment(3)))
    turning, least = _least_third_moment(spread.law)
    if wanted < least * spread.absolute**2:
        factor = pulse.life_mean() * least
        message = (
            'calibration "matched" has no solution: with this spread the exact mean area is at least '
            f"{factor:.7g} mean_junction_count * spread^2 = {factor * mean_count * spread.absolute**2:.7g} um^2"
        )
        hint = 'a larger area, fewer junctions, a smaller spread, or calibration = "exact"'
        raise Uncalibrated("mean_real_contact_area", message, hint)
    from scipy.optimize import brentq  # takes long to load, and few scenarios need it

    unit, top = wanted / spread.absolute**2, sqrt(wanted) / spread.absolute
    root = brentq(lambda r: _third_over_mean(r, spread.law) - unit, turning, top, xtol=1e-15, rtol=1e-15)
    return float(spread.absolute * root)


def _third_over_mean(mean: float, law: str) -> float:
    """Return E[d^3]/d_m of a law of unit spread."""
    return law_for(mean, Spread(absolute=1.0, law=law)).moment(3) / mean


@lru_cache(maxsize=16)
def _least_third_moment(law: str) -> tuple[float, float]:
    """Return the d_m at which E[d^3]/d_m is least for unit spread, and that least value.

    0.887855 and 3 * 1.609247 for the normal law, sqrt 2 and 27/4 for the lognormal, 2^(1/4) and 3 + 2 sqrt 2 for gamma.
    """
    from scipy.optimize import minimize_scalar

    found = minimize_scalar(_third_over_mean, bounds=_TURNING, args=(law,), method="bounded", options={"xatol": 1e-9})
    return float(found.x), float(found.fun)
