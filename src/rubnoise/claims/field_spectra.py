"""Published spectra of friction force and of motion: flat, 1/f, steep, and the effect of speed."""

from collections.abc import Sequence
from math import inf, nan

import numpy as np

from rubnoise.analysis.spectra import welch
from rubnoise.arrays import Doubles
from rubnoise.claims import sources
from rubnoise.claims.claim import ClaimedNumber
from rubnoise.claims.evidence import Found, Report, gather
from rubnoise.claims.field import FieldClaim, exponent_of
from rubnoise.model import Model
from rubnoise.record.memory import MemoryRecord
from rubnoise.theory.second_order import spectral_density

CONTACT = "claims/field_contact.toml"
FREE = "claims/field_free_mass.toml"
POWER_LAW = "claims/field_power_law.toml"

Band = tuple[float, float]
_SEGMENT = 500.0
"""Length of a segment of Welch's estimate, um."""
_PLATEAU: tuple[Band, Band] = ((0.025, 0.05), (0.1, 0.2))
"""Wavenumbers in rad/um below V/d of Figure 5, k L_jm = 0.3 to 2.2, two octaves apart."""
_WIDE_SEGMENT = 1000.0
_WIDE: tuple[Band, Band] = ((0.03, 0.06), (0.12, 0.24))
"""Wavenumbers in rad/um between those of the largest and of the smallest junctions of the power law."""
_FREE_SEGMENT = 4000.0
_FREE_BANDS: tuple[Band, Band] = ((0.01, 0.02), (0.08, 0.16))
"""Wavenumbers in rad/um, 10 to 160 rad/s: above the soft spring's resonance, below V/d."""


def claims(report: Report) -> Sequence[FieldClaim]:
    """Run the points and return the rows."""
    contact = gather(CONTACT, lambda model, record: _of_area(model, record, _SEGMENT, _PLATEAU), report).at(
        area=200.0, count=20
    )
    wide = gather(POWER_LAW, lambda model, record: _of_area(model, record, _WIDE_SEGMENT, _WIDE), report).at(count=20)
    free = gather(FREE, _of_velocity, report).at(count=20)
    return [_kilburn(contact), *_fingers(contact, wide), *_blocks(free)]


def _of_area(model: Model, record: MemoryRecord, segment: float, bands: tuple[Band, Band]) -> dict[str, float]:
    area = record["trace"]["real_contact_area"]
    spectrum = welch(area, model.tick, _ticks(model, segment))
    low, high = (_power(spectrum.wavenumber, spectrum.density, band) for band in bands)
    return {"low": low, "high": high}


def _of_velocity(model: Model, record: MemoryRecord) -> dict[str, float]:
    # The spectrum of velocity is less steep than that of displacement by 2, so less leaks from low wavenumbers.
    velocity = record["slider"]["velocity"]
    moving = velocity[velocity.size // 5 :]
    spectrum = welch(moving, model.tick, _ticks(model, _FREE_SEGMENT))
    low, high = (_power(spectrum.wavenumber, spectrum.density, band) for band in _FREE_BANDS)
    return {"low": low, "high": high}


def _ticks(model: Model, segment: float) -> int:
    return round(segment / model.tick)


def _power(wavenumber: Doubles, density: Doubles, band: Band) -> float:
    inside = (wavenumber >= band[0]) & (wavenumber <= band[1])
    return float(density[inside].mean())


def _bins(model: Model, segment: float, band: Band) -> Doubles:
    step = 2.0 * np.pi / (_ticks(model, segment) * model.tick)
    places = step * np.arange(1.0, np.ceil(band[1] / step) + 1.0)
    return places[(places >= band[0]) & (places <= band[1])]


def _fall(point: Found, segment: float, bands: tuple[Band, Band], name: str) -> ClaimedNumber:
    """Return the exponent with which the spectrum of the area falls from one band to the other."""
    places = [_bins(point.model, segment, band) for band in bands]
    exact = [float(spectral_density(point.model, place).mean()) for place in places]
    return exponent_of(
        name,
        (point.numbers["low"], exact[0]),
        (point.numbers["high"], exact[1]),
        bands[1][0] / bands[0][0],
        times=-1.0,
    )


def _kilburn(contact: Found) -> FieldClaim:
    return FieldClaim(
        id="kilburn1974_white",
        label="fall of $S$ below $V/d$",
        source=sources.KILBURN_1974,
        statement="Friction is a constant signal with superimposed white noise.",
        conditions="cast-iron button on a cast-iron disk, 60 runs; bandwidth not in the abstract",
        quantity=_fall(contact, _SEGMENT, _PLATEAU, "fall of S, k L_jm = 0.3 to 2.2"),
        published=(-0.1, 0.1),
        because="The force is white below V/d and only there: its tail is k^-4. White is taken as a fall by less "
        "than k^-0.1.",
        scenario=CONTACT,
    )


def _fingers(contact: Found, wide: Found) -> list[FieldClaim]:
    low, high = (
        float(spectral_density(contact.model, _bins(contact.model, _SEGMENT, band)).mean()) for band in _PLATEAU
    )
    factor = _PLATEAU[1][0] / _PLATEAU[0][0]
    faster = exponent_of(
        "exponent of speed, PSD of the force at one frequency",
        (contact.numbers["high"], high),
        (contact.numbers["low"].times(1.0 / factor), low / factor),
        factor,
    )
    return [
        FieldClaim(
            id="finger_equal_sizes",
            label="fall of $S$, one size",
            source=sources.FINGER_2011,
            statement="The background of the friction force follows a 1/f trend.",
            conditions="bare finger on smooth flat surfaces; here junctions of one size, as in Figure 5",
            quantity=_fall(contact, _SEGMENT, _PLATEAU, "fall of S, junctions of one size"),
            published=(0.8, 1.2),
            because="Junctions of one size are white below V/d, and fall as k^-4 above. 1/f is taken as k^-0.8 to "
            "k^-1.2.",
            scenario=CONTACT,
        ),
        FieldClaim(
            id="finger_power_law",
            label="fall of $S$, density $d^{-6}$",
            source=sources.FINGER_2011,
            statement="The background of the friction force follows a 1/f trend.",
            conditions="bare finger on smooth flat surfaces; here diameters with density d^-6 over a factor of 25",
            quantity=_fall(wide, _WIDE_SEGMENT, _WIDE, "fall of S, diameters with density d^-6"),
            published=(0.8, 1.2),
            because="Sizes with density d^-a give k^(a-7) between the wavenumbers of the largest and the smallest, "
            "because S(0) of a size is as d^6. So a = 6 gives 1/f. The exponent is chosen for this and not measured.",
            scenario=POWER_LAW,
        ),
        FieldClaim(
            id="brewer2016",
            label="$n$ of $S$ at one frequency",
            source=sources.BREWER_2016,
            statement="The 1/f background of the lateral force decreases with scanning speed.",
            conditions="finger on sinusoidal gratings, more so on compliant textures",
            quantity=faster,
            published=(-inf, 0.0),
            because="The variance stays and spreads over a band that widens as V, so the plateau falls as 1/V.",
            scenario=CONTACT,
        ),
    ]


def _blocks(free: Found) -> list[FieldClaim]:
    model = free.model
    slider, speed = model.slider, model.sliding_speed or nan
    exact = []
    for band in _FREE_BANDS:
        place = _bins(model, _FREE_SEGMENT, band)
        omega = place * speed
        stiffness, mass, damping = (
            (slider.stiffness, slider.mass, slider.damping) if slider is not None else (nan, nan, nan)
        )
        gain = np.square(stiffness - mass * omega**2) + np.square(damping * omega)
        exact.append(float((spectral_density(model, place) * omega**2 / gain).mean()))
    of_velocity = exponent_of(
        "fall of the displacement's PSD, 10 to 160 rad/s",
        (free.numbers["low"], exact[0]),
        (free.numbers["high"], exact[1]),
        _FREE_BANDS[1][0] / _FREE_BANDS[0][0],
        times=-1.0,
    )
    quantity = ClaimedNumber(
        name=of_velocity.name,
        simulated=of_velocity.simulated.plus(2.0),
        exact=of_velocity.exact + 2.0,
    )
    blocks = "rubber or PMMA blocks under constant driving force, low frequencies"
    return [
        FieldClaim(
            id="xu2025_measured",
            label="fall of $S_x$, measured",
            source=sources.XU_2025,
            statement="The PSD of displacement falls as omega^-g, g from 4 to 5; 4 without visible wear particles.",
            conditions=blocks,
            quantity=quantity,
            published=(3.9, 5.0),
            because="A free mass has S_x = S_F/(m^2 omega^4), and S_F is a plateau below V/d, so g = 4 there. A mass "
            "without any spring or dashpot leaves one-way coupling, because its speed wanders without bound. 4 is "
            "taken as 3.9 and more.",
            scenario=FREE,
        ),
        FieldClaim(
            id="xu2025_asperities",
            label="fall of $S_x$, of a model",
            source=sources.XU_2025,
            statement="A model of asperity forces, whose number and size fluctuate, has g = 6.",
            conditions="smooth block on a randomly rough substrate, without redistribution of load",
            quantity=quantity,
            published=(5.9, 6.1),
            because="Our forces fluctuate in number and size too, and have g = 4 below V/d. There is no g = 6: at V/d "
            "it steepens towards 8.",
            scenario=FREE,
        ),
    ]
