"""The interface of a law of births, and its entry in the registry."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

from rubnoise.arrays import Doubles


class BirthLaw(Protocol):
    """A stationary law of births along the sliding distance, with the exact second moments of their number.

    S_N(k) is the spectral density of births per um, lam = 1/mean their rate; it is lam for a Poisson process.
    """

    def __hash__(self) -> int:
        """Laws of equal parameters are one: tables are kept by law."""
        ...

    @property
    def mean(self) -> float:
        """Mean gap in um."""
        ...

    @property
    def dispersion(self) -> float:
        """S_N(0)/lam: variance over mean of the number of births in a long distance."""
        ...

    def excess(self, wavenumber: Doubles) -> Doubles:
        """Return S_N(k)/lam - 1 between lines, for k >= 0 in rad/um."""
        ...

    def line_share(self, wavenumber: Doubles) -> Doubles:
        """Return the power of a line at k = 2 pi n lam as a part of that of regular births."""
        ...

    @property
    def memory(self) -> float:
        """Distance in um beyond which births are independent to 1e-13; spectral lines are not counted."""
        ...


class GapLaw(BirthLaw, Protocol):
    """A law of births whose gaps are drawn one by one."""

    def gaps(self, uniform: Doubles) -> Doubles:
        """Return one gap in um for each uniform on [0, 1)."""
        ...

    def around(self, uniform: Doubles) -> tuple[float, float]:
        """Return the distances in um from a random place to the birth before it and to the next, from 2 uniforms.

        The first one is 0 for births without memory, since gaps may then end at the place itself.
        """
        ...


@dataclass(frozen=True, slots=True, kw_only=True)
class Key:
    """A key of its own that a law of births takes beside `law`: what a page says of it, and an ordinary value."""

    name: str
    about: str
    sample: str | float


@dataclass(frozen=True, slots=True, kw_only=True)
class BirthLawEntry:
    """A law of births: its name in scenarios, what a page says of it, the keys it takes, and how it is made.

    ``make`` takes mean_spacing (um) and the keys by name: lengths in um, ratios as parts of 1.
    """

    name: str
    about: str
    make: Callable[..., Any]
    keys: tuple[Key, ...] = ()
