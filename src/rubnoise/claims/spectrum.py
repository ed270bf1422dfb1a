"""Figures 8 and 9: what the spectrum of the real contact area does at small and at large wavenumbers."""

from collections.abc import Sequence
from math import log

import numpy as np
from numpy.typing import NDArray

from rubnoise.analysis.spectra import welch
from rubnoise.claims.claim import Claim, Quantity, Verdict, ratio, settled
from rubnoise.claims.evidence import Evidence, Found, Tell, gather
from rubnoise.model import Model
from rubnoise.record.memory import MemoryRecord
from rubnoise.theory.campbell import area_cumulants
from rubnoise.theory.spectrum import spectral_density

Doubles = NDArray[np.float64]

SCENARIO = "claims/spectrum.toml"

_SEGMENT_LIVES = 40
_BANDS = {
    "low": (0.3, 1.0),
    "half": (4.2, 4.8),
    "corner": (5.9, 6.7),
    "slope": (8.0, 10.0),
    "tail": (30.0, 60.0),
    "far_tail": (120.0, 240.0),
}
"""Wavenumber times mean life: the plateau, half power, a cycle a life, the slope after it, two octaves of the tail."""

_SAME = 0.05
"""Relative difference up to which two spectra count as the same."""


def claims(tell: Tell) -> Sequence[Claim]:
    """Run the points and settle the claims that Figures 8 and 9 make."""
    found = gather(SCENARIO, _measured, tell)
    paper = found.at(count=20)
    return [_decay(paper), _same(found), _floor(paper)]


def _measured(model: Model, record: MemoryRecord) -> dict[str, float]:
    segment = round(_SEGMENT_LIVES * model.mean_life_distance / model.tick)
    spectrum = welch(record["trace"]["real_contact_area"], model.tick, segment)
    return _numbers(model, spectrum.wavenumber, spectrum.density)


def _expected(model: Model) -> dict[str, float]:
    """Return what `_measured` would find without scatter, from the exact spectrum at the same wavenumbers."""
    step = 2.0 * np.pi / (round(_SEGMENT_LIVES * model.mean_life_distance / model.tick) * model.tick)
    highest = max(high for _, high in _BANDS.values()) / model.mean_life_distance
    wavenumber = step * np.arange(1.0, np.ceil(highest / step) + 1.0)
    return _numbers(model, wavenumber, spectral_density(model, wavenumber))


def _numbers(model: Model, wavenumber: Doubles, density: Doubles) -> dict[str, float]:
    phase = wavenumber * model.mean_life_distance
    power = {band: float(density[(phase >= low) & (phase <= high)].mean()) for band, (low, high) in _BANDS.items()}
    scale = area_cumulants(model).variance * model.mean_life_distance
    return {
        "low": power["low"],
        "half": power["half"] / power["low"],
        "corner": power["corner"] / power["low"],
        "exponent": log(power["far_tail"] / power["tail"]) / log(_BANDS["far_tail"][0] / _BANDS["tail"][0]),
        "scaled": power["low"] / scale,
        "scaled_slope": power["slope"] / scale,
    }


def _decay(paper: Found) -> Claim:
    exact = _expected(paper.model)
    half, corner = (
        Quantity(name=name, unit="", printed=None, simulated=paper.numbers[key], exact=exact[key])
        for name, key in (
            ("S at k L_jm = 4.5, over S at low wavenumbers", "half"),
            ("S at one cycle a life, over the same", "corner"),
        )
    )
    holds = corner.exact < 0.5 and corner.simulated.interval[1] < 0.5
    return Claim(
        name="psd_decay",
        where="Section 3, Fig. 8",
        says="The power spectral density is high at low spatial frequencies and decays very quickly with frequency.",
        quantities=(half, corner),
        verdict=settled(quantities=(half, corner), verdict=Verdict.HOLDS if holds else Verdict.FAILS),
        because="It is flat while a wave is longer than a life, 0.97 of S(0) at k L_jm = 1, falls to half where "
        "k L_jm = 4.50, which is 0.72 cycles a life, and then as k^-4 on average.",
        scenario=SCENARIO,
    )


def _floor(paper: Found) -> Claim:
    quantity = Quantity(
        name="exponent of S from k L_jm = 42 to 170",
        unit="",
        printed=0.0,
        simulated=paper.numbers["exponent"],
        exact=_expected(paper.model)["exponent"],
    )
    flat = abs(quantity.exact) < 0.5 and abs(quantity.simulated.value) < 0.5
    return Claim(
        name="psd_floor",
        where="Section 4",
        says="After its decay the spectral density stays constant, like the white noise that Kilburn observed.",
        quantities=(quantity,),
        verdict=settled(quantities=(quantity,), verdict=Verdict.HOLDS if flat else Verdict.FAILS),
        because="The model has no floor: its tail is 4 lam E[d^2]/k^4. What looks like one is leakage and aliasing of "
        "an estimate, or a linear axis; white noise the model is at low wavenumbers.",
        scenario=SCENARIO,
    )


def _same(found: Evidence) -> Claim:
    few, many = found.at(count=10), found.at(count=50)
    exact_few, exact_many = _expected(few.model), _expected(many.model)
    plain, scaled, slope = (
        Quantity(
            name=name,
            unit="",
            printed=printed,
            simulated=ratio(few.numbers[key], many.numbers[key]),
            exact=exact_few[key] / exact_many[key],
        )
        for name, key, printed in (
            ("S at low wavenumbers, 10 junctions over 50", "low", 1.0),
            ("the same over variance and life", "scaled", None),
            ("and that from k L_jm = 8 to 10", "scaled_slope", None),
        )
    )
    quantities = (plain, scaled, slope)
    holds = abs(plain.exact - 1.0) <= _SAME
    return Claim(
        name="psd_same",
        where="Section 3, Fig. 9",
        says="The number of junctions and their size have a negligible effect on the spectral density.",
        quantities=quantities,
        verdict=settled(quantities=quantities, verdict=Verdict.HOLDS if holds else Verdict.FAILS),
        because=f"S(0) goes with N_jm^-1.5: {_at_zero(few):.0f} and {_at_zero(many):.0f} um^4 per rad/um; and the "
        "corner goes with the diameter. Only divided by variance and life, and over k L_jm, do the curves fall on one "
        "another: up to k L_jm = 10 within 4.5 %, and exactly for equal sizes.",
        scenario=SCENARIO,
    )


def _at_zero(found: Found) -> float:
    """Return S(0) in um^4 per rad/um."""
    return float(spectral_density(found.model, 0.0))
