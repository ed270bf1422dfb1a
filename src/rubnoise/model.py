"""The physics of one run: frozen inputs in working units (um, s, kg) and quantities that follow directly from them."""

from dataclasses import dataclass, field
from math import pi, sqrt
from typing import Final, Literal

from rubnoise.contact.births import BirthLaw
from rubnoise.contact.distributions import Law
from rubnoise.contact.pulses import LENS, Pulse

Start = Literal["stationary", "empty"]

CELLS: Final = 50  # cells per diameter of a two-way motion, if no other number is given


@dataclass(frozen=True, slots=True, kw_only=True)
class Slider:
    """The oscillator that holds the slider: m x'' + c x' + k x = F (kg, N s/m, N/m; force in uN, x in um).

    coupling: whether the motion changes the sliding distance ("two-way") or not; cells: at least so many per diameter,
    in which a two-way motion knows the force. excitation: what drives it; of a base, asperity_height is the height of
    an asperity over its diameter, of velocity-weakening friction, slope (N s/m) is how fast the force falls with speed.
    """

    mass: float
    stiffness: float
    damping: float
    start: Literal["equilibrium", "rest"] = "equilibrium"
    coupling: Literal["one-way", "two-way"] = "one-way"
    cells: int = field(default=CELLS, repr=False)
    excitation: Literal["friction", "base", "velocity-weakening"] = "friction"
    asperity_height: float = 0.0
    slope: float = 0.0

    @property
    def natural_angular_frequency(self) -> float:
        """sqrt(k/m) in rad/s."""
        return sqrt(self.stiffness / self.mass)

    @property
    def natural_frequency(self) -> float:
        """sqrt(k/m) / 2 pi in Hz."""
        return self.natural_angular_frequency / (2.0 * pi)

    @property
    def damping_ratio(self) -> float:
        """Damping over critical damping, c / (2 sqrt(k m))."""
        return self.damping / (2.0 * sqrt(self.stiffness * self.mass))


@dataclass(frozen=True, slots=True, kw_only=True)
class Separation:
    """A separation that a load holds: m z'' + c z' = P - W, z in um beside the mean.

    load: W in uN; hardness: H in MPa, P being H times the area; height_scale: s_0 in um, over which the area falls by e
    as the slider rises; mass: m in kg, of the moving body; damping: c in N s/m. Of first order in z the contact
    is a spring: P = H A - W z/s_0, A being the area at constant separation.
    """

    load: float
    hardness: float
    height_scale: float
    mass: float
    damping: float

    @property
    def stiffness(self) -> float:
        """W/s_0 in N/m, of the contact."""
        return self.load / self.height_scale

    @property
    def oscillator(self) -> Slider:
        """The separation as a slider: s_0 + z is driven by H A, A being the area at constant separation."""
        return Slider(mass=self.mass, stiffness=self.stiffness, damping=self.damping)


@dataclass(frozen=True, slots=True, kw_only=True)
class FreeSeparation:
    """A separation that may leave the contact: m z'' + c z' = P - W, P from the encounters in contact; c may be 0.

    Exactly one loss is given: restitution e, by which the force of an overlap that shrinks is e^2 times as large; or
    impact_damping beta in s/um, the force then being max(0, 1 + beta r) times that of the overlap, r its rate (um/s).
    """

    held: Separation
    restitution: float | None = None
    impact_damping: float | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Model:
    """The complete input of a run and of the theory.

    A_rm (um^2), N_jm, d_m (um), the laws, V_sl (um/s; None if no times are wanted), sliding distance and tick (um);
    hardness H (MPa) if A_rm is that of a load. A load that weighs moves the separation, of first order or free: then
    all quantities of the model itself are those at constant separation.
    Ticks lie at i * tick for i = 0 ... tick_count; tick_count is the exact floor of distance/tick as written.
    """

    mean_real_contact_area: float
    mean_junction_count: float
    calibration: Literal["paper", "exact", "matched"]
    calibrated_diameter: float
    sizes: Law
    births: BirthLaw
    strengths: Law | None
    sliding_speed: float | None
    distance: float
    start: Start
    slider: Slider | None
    tick: float
    tick_count: int
    pulse: Pulse = LENS
    hardness: float | None = None
    separation: Separation | None = None
    free: FreeSeparation | None = None

    @property
    def load(self) -> float | None:
        """W = H A_rm in uN (Bowden and Tabor), or None without a hardness."""
        return None if self.hardness is None else self.hardness * self.mean_real_contact_area

    @property
    def held(self) -> Separation | None:
        """The separation that a load holds, of first order or free; None at constant separation."""
        return self.separation if self.free is None else self.free.held

    @property
    def mean_life_distance(self) -> float:
        """L_jm in um: 2 d_m (paper Eq. 13), or (pi/2) d_m if passes miss the centre line."""
        return self.pulse.mean_life * self.calibrated_diameter

    @property
    def mean_birth_spacing(self) -> float:
        """s_jm = L_jm / N_jm in um (paper, second Eq. 12)."""
        return self.births.mean_spacing

    @property
    def birth_rate(self) -> float:
        """Births per um of sliding, N_jm / L_jm."""
        return 1.0 / self.births.mean_spacing

    @property
    def mean_live_junctions(self) -> float:
        """E[N] = lam 2 m_1, (pi/2) m_1 off the centre line (Little's law); of Poisson births N is Poisson."""
        return self.birth_rate * self.pulse.mean_life * self.sizes.moment(1)

    @property
    def tick_duration(self) -> float | None:
        """Time in s from one tick to the next, or None without a sliding speed."""
        return None if self.sliding_speed is None else self.tick / self.sliding_speed

    @property
    def is_two_way(self) -> bool:
        """Whether the motion of a slider changes the sliding distance."""
        return self.slider is not None and self.slider.coupling == "two-way"

    @property
    def stationary_mean_area(self) -> float:
        """Exact stationary mean of the real contact area, lam c_1 E[d^3] in um^2 (Campbell); c_1 = 2/3 for the lens."""
        return self.birth_rate * self.pulse.life_integral(1) * self.sizes.moment(3)

    @property
    def base_per_area(self) -> float:
        """How high triangular lives of equal diameters lift the base of the slider, in um per um^2 of their area.

        A triangle of height r d has the area (pi/4) d^2: 4 r/(pi d), and 0 of a slider that no base drives.
        """
        if self.slider is None or self.slider.excitation != "base":
            return 0.0
        return 4.0 * self.slider.asperity_height / (pi * self.sizes.mean)

    @property
    def balanced_displacement(self) -> float:
        """Displacement in um at which the spring holds the mean friction force: psi times the stationary area over k.

        0 without a force; over a base, the mean of the base.
        """
        if self.base_per_area:
            return self.base_per_area * self.stationary_mean_area
        if self.slider is None or self.strengths is None:
            return 0.0
        return self.strengths.moment(1) * self.stationary_mean_area / self.slider.stiffness

    @property
    def equilibrium_displacement(self) -> float:
        """Displacement in um at which the slider starts: in balance, or 0 from rest or without a slider."""
        return 0.0 if self.slider is None or self.slider.start == "rest" else self.balanced_displacement
