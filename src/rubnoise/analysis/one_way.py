"""Warn if a slider moves too fast for the assumption of a constant sliding speed."""

from typing import TYPE_CHECKING, Final

if TYPE_CHECKING:
    from rubnoise.model import Model

WORTH_A_WARNING: Final = 0.1
"""Spread of the slider's velocity over the sliding speed from which one-way coupling is in doubt."""


def one_way_warnings(model: "Model", validity: float) -> list[str]:
    """Return warnings about one-way coupling for a spread of the slider's velocity, compared with the sliding speed.

    They advise two-way coupling only if the scenario allows it.
    """
    if model.slider is None or model.is_two_way or not validity > WORTH_A_WARNING:
        return []
    if model.slider.excitation == "base":
        return []  # which lifts the slider, normal to the sliding
    if model.held is not None:
        advice = "two-way coupling is known at constant separation alone, so without [load]"
    else:
        advice = f'two-way coupling (slider.coupling = "two-way") is needed above {WORTH_A_WARNING:g}'
    spread = f"the velocity of the slider spreads by {validity:.3g} times the sliding speed"
    return [f"{spread}, which one-way coupling takes for constant; {advice}"]
