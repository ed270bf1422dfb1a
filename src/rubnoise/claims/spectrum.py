"""Figures 8 and 9: the spectrum of the real contact area at small and at large wavenumbers."""

from collections.abc import Sequence
from math import log

import numpy as np

from rubnoise.analysis.replicates import ratio
from rubnoise.analysis.spectra import welch
from rubnoise.arrays import Doubles
from rubnoise.claims.claim import Claim, ClaimedNumber, Verdict
from rubnoise.claims.evidence import Evidence, Found, Report, gather
from rubnoise.model import Model
from rubnoise.record.memory import MemoryRecord
from rubnoise.theory.cumulants import area_cumulants
from rubnoise.theory.second_order import density_at_zero, spectral_density

SCENARIO = "claims/spectrum.toml"
TAIL = "claims/spectrum_tail.toml"

_SEGMENT_LIVES = 40
_BANDS = {
    "low": (0.3, 1.0),
    "half": (4.2, 4.8),
    "corner": (5.9, 6.7),
    "slope": (8.0, 10.0),
}
_TAIL_BANDS = {"tail": (30.0, 60.0), "far_tail": (120.0, 240.0)}
"""Wavenumber times mean life: the plateau, half power, a cycle a life, the slope after it; two octaves of the tail."""

SAME = 0.05
"""Relative difference up to which two spectra count as the same."""


def claims(report: Report) -> Sequence[Claim]:
    """Run the points and evaluate the claims that Figures 8 and 9 make."""
    found = gather(SCENARIO, in_bands, report)
    tail = gather(TAIL, _exponent, report)
    return [_decay(found.at(count=20)), _same(found), _floor(tail.at(count=20))]


def in_bands(model: Model, record: MemoryRecord) -> dict[str, float]:
    """Return the power of a run's area in bands of wavenumbers, by Welch's estimate, in um^4 per rad/um."""
    estimate = _estimate(model, record)
    return {name: _power(model, *estimate, band) for name, band in _BANDS.items()}


def _exponent(model: Model, record: MemoryRecord) -> dict[str, float]:
    estimate = _estimate(model, record)
    return {"exponent": _slope(*(_power(model, *estimate, band) for band in _TAIL_BANDS.values()))}


def _slope(near: float, far: float) -> float:
    """Return the exponent of a power law between the bands of the tail."""
    return log(far / near) / log(_TAIL_BANDS["far_tail"][0] / _TAIL_BANDS["tail"][0])


def _estimate(model: Model, record: MemoryRecord) -> tuple[Doubles, Doubles]:
    spectrum = welch(record["trace"]["real_contact_area"], model.tick, _ticks(model))
    return spectrum.wavenumber, spectrum.density


def _ticks(model: Model) -> int:
    """Return the ticks of a segment: as many lives of each model, so that bands hold the same multiples of 1/L_jm."""
    return round(_SEGMENT_LIVES * model.mean_life_distance / model.tick)


def _power(model: Model, wavenumber: Doubles, density: Doubles, band: tuple[float, float]) -> float:
    phase, (low, high) = wavenumber * model.mean_life_distance, band
    return float(density[(phase >= low) & (phase <= high)].mean())


def _exact_power(model: Model, band: tuple[float, float]) -> float:
    """Return the power in a band without scatter, from the exact spectrum at the wavenumbers of an estimate."""
    step = 2.0 * np.pi / (_ticks(model) * model.tick)
    wavenumber = step * np.arange(1.0, np.ceil(band[1] / model.mean_life_distance / step) + 1.0)
    return _power(model, wavenumber, spectral_density(model, wavenumber), band)


def _decay(paper: Found) -> Claim:
    from scipy.optimize import brentq

    low = _exact_power(paper.model, _BANDS["low"])
    half, corner = (
        ClaimedNumber(
            name=name,
            # Of means, since the mean of ratios is too large; bands that do not touch are independent to first order.
            simulated=ratio(paper.numbers[key], paper.numbers["low"]),
            exact=_exact_power(paper.model, _BANDS[key]) / low,
        )
        for name, key in (
            ("S at k L_jm = 4.5, over S at low wavenumbers", "half"),
            ("S at one cycle per life, over the same", "corner"),
        )
    )
    holds = corner.exact < 0.5 and corner.simulated.interval[1] < 0.5
    corner_at = float(brentq(lambda phase: _over_zero(paper.model, phase) - 0.5, 1.0, 2.0 * np.pi))
    return Claim(
        name="psd_decay",
        where="Section 3, Fig. 8",
        says="The power spectral density is high at low spatial frequencies and decays very quickly with frequency.",
        quantities=(half, corner),
        if_agreed=Verdict.HOLDS if holds else Verdict.FAILS,
        because=f"It is flat for waves longer than a life: {_over_zero(paper.model, 1.0):.2f} of S(0) at k L_jm = 1. "
        f"It is a half at k L_jm = {corner_at:.2f}, which is {corner_at / (2.0 * np.pi):.2f} cycles per life. Then it "
        "falls as k^-4 on average.",
        scenario=SCENARIO,
    )


def _floor(paper: Found) -> Claim:
    quantity = ClaimedNumber(
        name="exponent of S from k L_jm = 42 to 170",
        printed=0.0,
        simulated=paper.numbers["exponent"],
        exact=_slope(*(_exact_power(paper.model, band) for band in _TAIL_BANDS.values())),
    )
    flat = abs(quantity.exact) < 0.5 and abs(quantity.simulated.value) < 0.5
    return Claim(
        name="psd_floor",
        where="Section 4",
        says="After its decay the spectral density stays constant, like the white noise that Kilburn observed.",
        quantities=(quantity,),
        if_agreed=Verdict.HOLDS if flat else Verdict.FAILS,
        because="The model has no floor: its tail is 4 lam E[d^2]/k^4. Leakage and aliasing of an estimate, or a "
        "linear axis, look like a floor. The model is white noise at low wavenumbers only. The exponent -4 comes "
        "from the kink at mid-life, because each pass goes through both centres, as in the paper. For centres that "
        "pass at distances spread evenly from 0 to d, the tail is k^-5, which is not a floor either.",
        scenario=TAIL,
    )


def power_ratio(one: Found, other: Found, name: str, band: str = "low", *, scaled: bool = False) -> ClaimedNumber:
    """Return the power of one point over that of another in a band, ``scaled`` by variance and life of each."""
    factor = variance_and_life(other.model) / variance_and_life(one.model) if scaled else 1.0
    exact = _exact_power(one.model, _BANDS[band]) / _exact_power(other.model, _BANDS[band])
    return ClaimedNumber(
        name=name,
        printed=None if scaled else 1.0,
        simulated=ratio(one.numbers[band], other.numbers[band]).times(factor),
        exact=factor * exact,
    )


def variance_and_life(model: Model) -> float:
    """Return the exact variance of the area times the mean life, um^5."""
    return area_cumulants(model).variance * model.mean_life_distance


def _same(found: Evidence) -> Claim:
    few, many = found.at(count=10), found.at(count=50)
    plain = power_ratio(few, many, "S at low wavenumbers, 10 junctions over 50")
    scaled = power_ratio(few, many, "the same over variance and life", scaled=True)
    slope = power_ratio(few, many, "and that from k L_jm = 8 to 10", "slope", scaled=True)
    holds = abs(plain.exact - 1.0) <= SAME
    return Claim(
        name="psd_same",
        where="Section 3, Fig. 9",
        says="At one mean area, the number of junctions (and so their size) has a negligible effect on the spectral "
        "density.",
        quantities=(plain, scaled, slope),
        if_agreed=Verdict.HOLDS if holds else Verdict.FAILS,
        because=f"S(0) is proportional to N_jm^-1.5: {density_at_zero(few.model):.0f} and "
        f"{density_at_zero(many.model):.0f} um^4 per rad/um. The corner moves with the diameter. The curves agree "
        "only if you divide them by variance and life and plot them over k L_jm: within "
        f"{100.0 * _apart(few.model, many.model):.1f} % up to k L_jm = 10, and exactly for equal sizes.",
        scenario=SCENARIO,
    )


def _over_zero(model: Model, phase: float) -> float:
    """Return S over S(0) at the k for which k L_jm is ``phase``."""
    return float(spectral_density(model, phase / model.mean_life_distance)) / density_at_zero(model)


def _apart(one: Model, other: Model) -> float:
    """Return the largest relative difference of two spectra up to k L_jm = 10, over variance and life."""
    phase = np.linspace(0.0, 10.0, 1001)
    first, second = (
        spectral_density(model, phase / model.mean_life_distance) / variance_and_life(model) for model in (one, other)
    )
    return float(np.abs(first / second - 1.0).max())
