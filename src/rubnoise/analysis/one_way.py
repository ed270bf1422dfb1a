"""From when on a slider moves too fast for a sliding speed that is taken for constant, and how to say so."""

from typing import Final

WORTH_A_WARNING: Final = 0.1
"""Spread of the slider's velocity over the sliding speed from which one-way coupling is in doubt."""


def one_way_warning(validity: float) -> str:
    """Return what a spread of the slider's velocity beside the sliding speed means for one-way coupling."""
    return (
        f"the velocity of the slider spreads by {validity:.3g} times the sliding speed,"
        " which one-way coupling takes for constant; two-way coupling"
        f' (slider.coupling = "two-way") is needed above {WORTH_A_WARNING:g}'
    )
