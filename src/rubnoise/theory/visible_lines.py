"""The lines of a spectrum that are more than rounding."""

import numpy as np
from numpy.typing import NDArray

from rubnoise.model import Model
from rubnoise.theory.campbell import area_cumulants
from rubnoise.theory.lines import spectral_lines

Doubles = NDArray[np.float64]

_ROUNDING = 1e-26


def visible_lines(model: Model) -> tuple[Doubles, Doubles]:
    """Return wavenumbers in rad/um and powers in um^4 of the lines above 1e-26 of the squared mean area.

    Of triangles of one size every second line, or all of them, should be 0 and is left over from sums that cancel.
    Equation and source are those of `rubnoise.theory.lines.spectral_lines`; none for births at random.
    """
    wavenumber, power = spectral_lines(model)
    told = power > _ROUNDING * area_cumulants(model).mean ** 2
    return wavenumber[told], power[told]
