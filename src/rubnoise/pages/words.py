"""A scenario in words: what slides, how its junctions live, and what holds the slider."""

from rubnoise.model import Model
from rubnoise.theory.campbell import area_cumulants


def in_words(model: Model) -> list[str]:
    """Return sentences about a model, each with the numbers that matter."""
    area = area_cumulants(model)
    lines = [
        (
            f"Two rough surfaces slide over {_length(model.distance)}. Where their asperities meet, junctions are born,"
            f" grow to {'a full overlap' if model.pulse.offset == 'none' else 'a largest overlap'}, shrink and die."
        ),
        (
            f"On average {model.mean_junction_count:.4g} junctions live at once. One is born every"
            f" {model.mean_birth_spacing:.4g} um of sliding, and each lives for about"
            f" {model.mean_life_distance:.4g} um."
        ),
        (
            f"The area of a junction rises and falls as a {model.pulse.shape}. The areas of all live junctions add up"
            f" to the real contact area: {area.mean:.4g} um² on average, with a standard deviation of"
            f" {area.std:.3g} um²."
        ),
    ]
    if model.pulse.offset != "none":
        lines.append(
            "The centres of two asperities miss each other by a lateral offset, anything up to the diameter on either"
            " side. The larger the offset, the shorter the life and the smaller the area."
        )
    if model.sliding_speed is not None:
        lines.append(f"The sliding speed is {model.sliding_speed / 1000.0:.4g} mm/s.")
    if model.strengths is not None:
        strength = model.strengths.moment(1)
        lines.append(f"The friction force is the area times the shear strength, {strength:.4g} MPa on average.")
    if model.slider is not None:
        lines.append(_slider(model))
    return lines


def _slider(model: Model) -> str:
    slider = model.slider
    if slider is None:
        raise AssertionError("a model without a slider has nothing to say of it")
    words = (
        f"The force moves a slider of {1000.0 * slider.mass:.4g} g on a spring of {slider.stiffness:.4g} N/m."
        f" Its natural frequency is {slider.natural_frequency:.4g} Hz and its damping ratio {slider.damping_ratio:.3g}."
    )
    if model.is_two_way:
        return words + " The coupling is two-way: the motion of the slider changes how fast the surfaces slide."
    return words + " The coupling is one-way: the surfaces slide at constant speed, however the slider moves."


def _length(um: float) -> str:
    for unit, size in (("m", 1e6), ("mm", 1e3)):
        if um >= size:
            return f"{um / size:.4g} {unit}"
    return f"{um:.4g} um"
