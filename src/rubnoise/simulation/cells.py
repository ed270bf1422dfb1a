"""How finely a tick must be divided for the slider."""

from rubnoise.model import Model


def cells_per_tick(model: Model) -> int:
    return 1
