"""The words of a report about a run: the contact, the motion, and whether the assumptions hold."""

from collections.abc import Sequence
from math import isfinite
from typing import Final

from rubnoise.analysis.landmarks import Flights
from rubnoise.analysis.moments import one_way_warnings
from rubnoise.answer import Row, length
from rubnoise.figures.tracks import Stretch
from rubnoise.model import FreeSeparation, Model, Slider
from rubnoise.theory.coupling import free_motion, load_motion
from rubnoise.theory.moments import area_cumulants

_SMALLEST, _LARGEST = 1e-4, 1e7  # of numbers that are written without a power of ten
_RAISED: Final = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def _length(model: Model) -> str:
    return length(model.distance, 4).replace("um", "µm")


def number(value: float | None, digits: int = 6) -> str:
    """Return a number in plain notation with some digits; an empty text if it is not known."""
    if value is None or not isfinite(value):
        return ""
    digits_of, _, power = f"{value:.{digits}g}".partition("e")
    if power and not _SMALLEST <= abs(value) < _LARGEST:
        return f"{digits_of}\u00d710{str(int(power)).translate(_RAISED)}"
    return f"{float(f'{value:.{digits}g}'):,.10g}"


def in_words(model: Model) -> list[str]:
    """Return sentences about a model, with its main numbers."""
    lines = _contact(model) if model.free is None else _free_contact(model, model.free)
    if model.sliding_speed is not None:
        lines.append(f"The sliding speed is {model.sliding_speed / 1000.0:.4g} mm/s.")
    if model.strengths is not None:
        strength = model.strengths.moment(1)
        borne = "area" if model.separation is None else "load on the junctions over their hardness"
        lines.append(f"The friction force is the {borne} times the shear strength, {strength:.4g} MPa on average.")
    if model.free is None:
        lines.append(_separation(model))
    if model.slider is not None:
        lines.append(_slider(model.slider, two_way=model.is_two_way))
    return lines


def _free_contact(model: Model, free: FreeSeparation) -> list[str]:
    """Return sentences about the contact of a slider that may leave it, and the loss of an impact."""
    known, held = free_motion(model), free.held
    loss = (
        f"An overlap that shrinks pushes with {free.restitution**2:.3g} times the force of one that grows"
        f" (restitution {free.restitution:.3g})."
        if free.restitution is not None
        else "An overlap pushes harder while it grows and less while it shrinks (Hunt and Crossley)."
    )
    return [
        (
            f"A slider of {1000.0 * held.mass:.4g} g slides over {_length(model)} of a rough surface under its"
            f" load of {1e-6 * held.load:.4g} N. It may leave the surface and fall back on it."
        ),
        (
            f"At rest {known.live:.4g} summits would carry it on average, with heights that vary by"
            f" {held.height_scale:.4g} µm. It then swings on them at {known.contact_resonance:.4g} Hz, and slides"
            f" {known.relative_speed:.3g} times as fast as it can follow them."
        ),
        loss,
    ]


def flights_in_words(stretch: Stretch) -> list[str]:
    """Return how long a slider was off the surface, how often it fell on it, and the largest speed of an overlap."""
    file = stretch.file
    if stretch.has_theory or file.rows("load") < 2:
        return []
    end = float(file.column("load", "time", file.rows("load") - 1, file.rows("load"))[0])
    found = Flights.of(file, 0.0, end)
    if not found.impacts.size:
        return ["It never fell on the surface."]
    off, hardest = 100.0 * found.share(0.0, end), 1e-3 * float(found.speeds.max())
    often = found.impacts.size / end
    return [
        (
            f"It was off the surface for {off:.3g} % of the time, and fell on it {often:.3g} times a second."
            f" At the hardest impact an overlap grew at {hardest:.3g} mm/s, by sliding and falling together."
        )
    ]


def _contact(model: Model) -> list[str]:
    """Return sentences about a contact that the slider does not leave."""
    area = area_cumulants(model)
    lines = [
        (
            f"Two rough surfaces slide over {_length(model)}. Where their asperities meet, junctions are born,"
            f" grow to {'a full overlap' if model.pulse.offset == 'none' else 'a largest overlap'}, shrink and die."
        ),
        (
            f"On average {model.mean_junction_count:.4g} junctions live at once. One is born every"
            f" {model.mean_birth_spacing:.4g} µm of sliding, and each lives for about"
            f" {model.mean_life_distance:.4g} µm."
        ),
        (
            f"The area of a junction rises and falls as a {model.pulse.shape}. The areas of all live junctions add up"
            f" to the real contact area: {area.mean:.4g} µm² on average, with a standard deviation of"
            f" {area.std:.3g} µm²."
        ),
    ]
    if model.pulse.offset != "none":
        lines.append(
            "The centres of two asperities miss each other by a lateral offset, anything up to the diameter on either"
            " side. The larger the offset, the shorter the life and the smaller the area."
        )
    return lines


def _separation(model: Model) -> str:
    """Return how the separation moves, or that it is held."""
    held = model.separation
    if model.slider is not None and model.slider.excitation == "base":
        return "Asperities lift the slider: it moves normal to the surfaces."
    if held is None:
        return "The separation of the surfaces is held, so that the load varies as the area does."
    motion = load_motion(model)
    held_back = f" The slider moves {motion.suppression:.3g} times less along the surface than at constant separation."
    return (
        f"The slider rests on its load of {1e-6 * held.load:.4g} N, and rises and falls with a contact resonance of"
        f" {held.oscillator.natural_frequency:.4g} Hz: the regime is {motion.regime}."
        f"{'' if model.slider is None else held_back}"
    )


def _slider(slider: Slider, *, two_way: bool) -> str:
    driven = "A base that asperities lift" if slider.excitation == "base" else "The force"
    words = (
        f"{driven} moves a slider of {1000.0 * slider.mass:.4g} g on a spring of {slider.stiffness:.4g} N/m."
        f" Its natural frequency is {slider.natural_frequency:.4g} Hz and its damping ratio {slider.damping_ratio:.3g}."
    )
    if two_way:
        return words + " The coupling is two-way: the motion of the slider changes how fast the surfaces slide."
    return words + " The coupling is one-way: the surfaces slide at constant speed, however the slider moves."


def motion_in_words(model: Model, figures: Sequence[Row]) -> list[str]:
    """Return sentences about the measured motion: whether one-way coupling holds, or how the slider sticks."""
    measured = {each.name: each.value for each in figures}
    lines = []
    if "one_way_validity" in measured and model.slider is not None and model.slider.excitation == "friction":
        lines.append(_one_way(model, measured["one_way_validity"]))
    if "stick_fraction" in measured:
        lines.append(
            f"The slider moves with the drive, stuck to the surface, for"
            f" {number(100.0 * measured['stick_fraction'], 3)} % of the time. It sticks"
            f" {number(measured['sticks_per_s'], 3)} times a second. Each time it then breaks away and slips."
        )
    return lines


def _one_way(model: Model, validity: float) -> str:
    for warning in one_way_warnings(model, validity):
        return f"{warning[0].upper()}{warning[1:]}."
    return (
        f"The velocity of the slider spreads by {validity:.3g} times the sliding speed, so that it is fair to take the"
        " sliding speed for constant."
    )
