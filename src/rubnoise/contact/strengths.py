"""How strong a junction is: the laws of the shear strength that turns its area into a friction force."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray


class StrengthLaw(Protocol):
    """A law of shear strengths psi in MPa, independent of the diameters."""

    @property
    def mean(self) -> float:
        """E[psi] in MPa."""
        ...

    def moment(self, power: int) -> float:
        """Return E[psi^n] in MPa^n, exact for the law as it is drawn."""
        ...

    def draw(self, uniform: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return one strength in MPa for each uniform on [0, 1)."""
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class ConstantStrength:
    """Every junction has the same shear strength psi, in MPa (paper: "we assume equal strength").

    Moments: E[psi^n] = psi^n.
    """

    mean: float

    def moment(self, power: int) -> float:
        """Return E[psi^n] in MPa^n."""
        return self.mean**power

    def draw(self, uniform: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return one strength in MPa for each uniform on [0, 1)."""
        return np.full(uniform.shape, self.mean)
