"""The balance of a two-way run: its mean force and its energy, from the end of the motion and integrals over it.

With s = V t - (x - x_0), w = V - x' and F the friction force on the slider, m x'' + c x' + k x = F gives

    int F dt       = m [x'] + c [x] + k int x dt
    V int F dt     = int G |ds| + c int x'^2 dt + [E]            E = m x'^2/2 + k x^2/2
    int G |ds|     = int G ds + 2 int_(w < 0) G |ds|

with G the force that the contact can bear and [...] the gain of a quantity over the run. During a stick F does work,
too: F V. The second line is the balance of energy. Divided by V T it is the law of the mean force, which exceeds the
mean of G over distance by the work of the dashpot, twice the work of reversals, and the stored energy.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Self

from rubnoise.model import Model, Slider
from rubnoise.theory.motion import drive_of


@dataclass(frozen=True, slots=True, kw_only=True)
class Balance:
    """The row of /balance in its units (um, s, uN), with the slider, the speed (um/s) and the start (um) that it needs.

    Every run begins at rest: x' = 0.
    """

    slider: Slider
    speed: float
    start: float
    time: float
    distance: float
    displacement: float
    velocity: float
    time_stuck: float
    displacement_integral: float
    displacement_squared_integral: float
    velocity_squared_integral: float
    friction_work: float
    reverse_work: float

    @classmethod
    def columns(cls) -> tuple[str, ...]:
        """Return the columns of /balance."""
        return tuple(each.name for each in fields(cls) if each.name not in {"slider", "speed", "start"})

    @classmethod
    def of(cls, model: Model, row: Mapping[str, float]) -> Self:
        """Return the balance of a run of a model; raises Refused without slider, strength or speed."""
        drive = drive_of(model)
        kept = {name: row[name] for name in cls.columns()}
        return cls(slider=drive.slider, speed=drive.speed, start=model.equilibrium_displacement, **kept)

    @property
    def impulse(self) -> float:
        """Impulse of the friction force, int F dt, in uN s."""
        slider = self.slider
        held = slider.mass * self.velocity + slider.damping * (self.displacement - self.start)
        return held + slider.stiffness * self.displacement_integral

    @property
    def dissipated(self) -> float:
        """Energy dissipated by the dashpot, c int x'^2 dt, in uN um."""
        return self.slider.damping * self.velocity_squared_integral

    @property
    def stored(self) -> float:
        """Energy gained over the run, [E], in uN um."""
        slider = self.slider
        moved = slider.stiffness * (self.displacement - self.start) * (self.displacement + self.start)
        return 0.5 * (slider.mass * self.velocity * self.velocity + moved)

    @property
    def scale(self) -> float:
        """Largest of the works in uN um, the scale of residuals."""
        slider = self.slider
        held = 0.5 * slider.stiffness * max(self.displacement * self.displacement, self.start * self.start)
        return max(abs(self.speed * self.impulse), self.friction_work, self.dissipated, held)

    @property
    def energy_residual(self) -> float:
        """Residual of the energy balance over its largest term: 0 except for the errors of the steps."""
        missing = self.speed * self.impulse - (self.friction_work + self.dissipated + self.stored)
        return missing / self.scale if self.scale > 0.0 else 0.0

    @property
    def friction_along(self) -> float:
        """Signed int G ds in uN um over the whole path: a reversal and the way back cancel."""
        return self.friction_work - 2.0 * self.reverse_work

    @property
    def mean_force(self) -> float:
        """Mean of F over time in uN."""
        return self.impulse / self.time

    def expected_excess(self) -> float:
        """Return the excess in uN of <F> over int G ds/(V T): (c int x'^2 dt + 2 int_(w < 0) G |ds| + [E])/(V T)."""
        return (self.dissipated + 2.0 * self.reverse_work + self.stored) / (self.speed * self.time)

    def excess_over(self, friction_along: float) -> float:
        """Return <F> less an int G ds (uN um) over V T, in uN."""
        return self.mean_force - friction_along / (self.speed * self.time)
