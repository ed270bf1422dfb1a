"""The words of a report about a run: the contact, the motion, and whether the assumptions hold."""

from collections.abc import Iterator, Mapping
from typing import Any

from rubnoise.analysis.landmarks import Flights
from rubnoise.analysis.moments import one_way_warnings
from rubnoise.answer import length
from rubnoise.figures.tracks import Stretch
from rubnoise.model import Model
from rubnoise.pages.page import last_time


def in_words(stretch: Stretch, measured: Mapping[str, Any]) -> list[str]:
    """Return sentences about a run and its model; numbers stand in the table below them."""
    model = stretch.model
    return [*_contact(model), *_driven(model), *_flights(stretch), *_motion(model, measured)]


def _contact(model: Model) -> Iterator[str]:
    """Yield what slides, and what the contact is made of."""
    way, free = length(model.distance, 4).replace("um", "µm"), model.free
    if free is not None:
        yield (
            f"A slider of {1000.0 * free.held.mass:.4g} g slides over {way} of a rough surface under its load of"
            f" {1e-6 * free.held.load:.4g} N. It may leave the surface and fall back on it."
        )
        if free.restitution is None:
            yield "An overlap pushes harder while it grows and less while it shrinks (Hunt and Crossley)."
        else:
            yield (
                f"An overlap that shrinks pushes with {free.restitution**2:.3g} times the force of one that grows"
                f" (restitution {free.restitution:.3g})."
            )
        return
    centred = model.pulse.offset == "none"
    yield (
        f"Two rough surfaces slide over {way}. Where their asperities meet, junctions are born, grow to a"
        f" {'full' if centred else 'largest'} overlap, shrink and die."
    )
    yield (
        f"On average {model.mean_junction_count:.4g} junctions live at once. One is born every"
        f" {model.mean_birth_spacing:.4g} µm of sliding, and each lives for about {model.mean_life_distance:.4g} µm."
    )
    yield (
        f"The area of a junction rises and falls as a {model.pulse.shape}. The areas of all live junctions add up to"
        " the real contact area."
    )
    if not centred:
        yield (
            "The centres of two asperities miss each other by a lateral offset, anything up to the diameter on either"
            " side. The larger the offset, the shorter the life and the smaller the area."
        )


def _driven(model: Model) -> Iterator[str]:
    """Yield what the contact drives, and what carries the load."""
    if model.strengths is not None:
        borne = "area" if model.separation is None else "load on the junctions over their hardness"
        yield f"The friction force is the {borne} times the shear strength."
    lifted = model.slider is not None and model.slider.excitation == "base"
    if lifted:
        yield "Asperities lift the slider: it moves normal to the surfaces."
    elif model.separation is not None:
        yield "The slider rests on its load, and rises and falls with the resonance of its contact."
    elif model.free is None:
        yield "The separation of the surfaces is held, so that the load varies as the area does."
    if model.slider is not None:
        coupling = "one-way: the surfaces slide at constant speed, however the slider moves"
        if model.is_two_way:
            coupling = "two-way: the motion of the slider changes how fast the surfaces slide"
        driven = "A base that asperities lift" if lifted else "The force"
        yield f"{driven} moves a slider on a spring. The coupling is {coupling}."


def _flights(stretch: Stretch) -> Iterator[str]:
    """Yield how long a slider was off the surface, how often it fell on it, and the largest speed of an overlap."""
    if stretch.has_theory or stretch.file.rows("load") < 2:
        return
    end = last_time(stretch.file, "load")
    found = Flights.of(stretch.file, 0.0, end)
    if not found.impacts.size:
        yield "It never fell on the surface."
        return
    yield (
        f"It was off the surface for {100.0 * found.share(0.0, end):.3g} % of the time, and fell on it"
        f" {found.impacts.size / end:.3g} times a second. At the hardest impact an overlap grew at"
        f" {1e-3 * float(found.speeds.max()):.3g} mm/s, by sliding and falling together."
    )


def _motion(model: Model, measured: Mapping[str, Any]) -> Iterator[str]:
    """Yield what the measured motion says: whether one-way coupling holds, or how the slider sticks."""
    if "one_way_validity" in measured and model.slider is not None and model.slider.excitation != "base":
        validity = measured["one_way_validity"]
        fair = f"the velocity of the slider spreads by {validity:.3g} times the sliding speed, which is little"
        said = [*one_way_warnings(model, validity), fair][0]
        yield f"{said[:1].upper()}{said[1:]}."
    if "stick_fraction" in measured:
        yield (
            f"The slider moves with the drive, stuck to the surface, for {100.0 * measured['stick_fraction']:.3g} % of"
            f" the time. It sticks {measured['sticks_per_s']:.3g} times a second. Each time it then breaks away and"
            " slips."
        )
