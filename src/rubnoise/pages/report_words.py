"""The words of a report about a run: the contact, the motion, and whether the assumptions hold."""

from collections.abc import Mapping

from rubnoise.analysis.landmarks import Flights
from rubnoise.analysis.moments import one_way_warnings
from rubnoise.answer import length
from rubnoise.figures.tracks import Stretch
from rubnoise.model import FreeSeparation, Model
from rubnoise.pages.page import last_time


def in_words(stretch: Stretch, measured: Mapping[str, float]) -> list[str]:
    """Return sentences about a run and its model; numbers stand in the table below them."""
    model = stretch.model
    lines = _contact(model) if model.free is None else _free_contact(model, model.free)
    if model.strengths is not None:
        borne = "area" if model.separation is None else "load on the junctions over their hardness"
        lines.append(f"The friction force is the {borne} times the shear strength.")
    lifted = model.slider is not None and model.slider.excitation == "base"
    if lifted:
        lines.append("Asperities lift the slider: it moves normal to the surfaces.")
    elif model.separation is not None:
        lines.append("The slider rests on its load, and rises and falls with the resonance of its contact.")
    elif model.free is None:
        lines.append("The separation of the surfaces is held, so that the load varies as the area does.")
    if model.slider is not None:
        driven = "A base that asperities lift" if lifted else "The force"
        coupling = (
            "two-way: the motion of the slider changes how fast the surfaces slide"
            if model.is_two_way
            else "one-way: the surfaces slide at constant speed, however the slider moves"
        )
        lines.append(f"{driven} moves a slider on a spring. The coupling is {coupling}.")
    return lines + _flights(stretch) + _motion(model, measured, lifted=lifted)


def _length(model: Model) -> str:
    return length(model.distance, 4).replace("um", "µm")


def _free_contact(model: Model, free: FreeSeparation) -> list[str]:
    """Return sentences about the contact of a slider that may leave it, and the loss of an impact."""
    loss = "An overlap pushes harder while it grows and less while it shrinks (Hunt and Crossley)."
    if free.restitution is not None:
        loss = (
            f"An overlap that shrinks pushes with {free.restitution**2:.3g} times the force of one that grows"
            f" (restitution {free.restitution:.3g})."
        )
    return [
        (
            f"A slider of {1000.0 * free.held.mass:.4g} g slides over {_length(model)} of a rough surface under its"
            f" load of {1e-6 * free.held.load:.4g} N. It may leave the surface and fall back on it."
        ),
        loss,
    ]


def _contact(model: Model) -> list[str]:
    """Return sentences about a contact that the slider does not leave."""
    centred = model.pulse.offset == "none"
    lines = [
        (
            f"Two rough surfaces slide over {_length(model)}. Where their asperities meet, junctions are born,"
            f" grow to a {'full' if centred else 'largest'} overlap, shrink and die."
        ),
        (
            f"On average {model.mean_junction_count:.4g} junctions live at once. One is born every"
            f" {model.mean_birth_spacing:.4g} µm of sliding, and each lives for about"
            f" {model.mean_life_distance:.4g} µm."
        ),
        (
            f"The area of a junction rises and falls as a {model.pulse.shape}. The areas of all live junctions add up"
            " to the real contact area."
        ),
    ]
    if not centred:
        lines.append(
            "The centres of two asperities miss each other by a lateral offset, anything up to the diameter on either"
            " side. The larger the offset, the shorter the life and the smaller the area."
        )
    return lines


def _flights(stretch: Stretch) -> list[str]:
    """Return how long a slider was off the surface, how often it fell on it, and the largest speed of an overlap."""
    if stretch.has_theory or stretch.file.rows("load") < 2:
        return []
    end = last_time(stretch.file, "load")
    found = Flights.of(stretch.file, 0.0, end)
    if not found.impacts.size:
        return ["It never fell on the surface."]
    off, often = 100.0 * found.share(0.0, end), found.impacts.size / end
    hardest = 1e-3 * float(found.speeds.max())
    return [
        (
            f"It was off the surface for {off:.3g} % of the time, and fell on it {often:.3g} times a second."
            f" At the hardest impact an overlap grew at {hardest:.3g} mm/s, by sliding and falling together."
        )
    ]


def _motion(model: Model, measured: Mapping[str, float], *, lifted: bool) -> list[str]:
    """Return sentences about the measured motion: whether one-way coupling holds, or how the slider sticks."""
    lines = []
    if "one_way_validity" in measured and not lifted:
        validity = measured["one_way_validity"]
        fair = f"the velocity of the slider spreads by {validity:.3g} times the sliding speed, which is little"
        warnings = [*one_way_warnings(model, validity), fair]
        lines.append(f"{warnings[0][:1].upper()}{warnings[0][1:]}.")
    if "stick_fraction" in measured:
        lines.append(
            f"The slider moves with the drive, stuck to the surface, for {100.0 * measured['stick_fraction']:.3g} % of"
            f" the time. It sticks {measured['sticks_per_s']:.3g} times a second. Each time it then breaks away and"
            " slips."
        )
    return lines
