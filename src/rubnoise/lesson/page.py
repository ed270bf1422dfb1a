"""The page of lessons: one self-contained file, made of its parts, tables of theory, and the junctions it replays."""

import json
from collections.abc import Sequence
from functools import cache
from html import escape
from importlib.resources import files
from itertools import pairwise
from typing import Any, Final

import numpy as np
from numpy.polynomial.chebyshev import Chebyshev
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.special import j1

from rubnoise.api.run import Run
from rubnoise.api.running import simulate
from rubnoise.contact.births import PoissonBirths, RegularBirths
from rubnoise.contact.distributions import Fixed, Normal
from rubnoise.contact.pulses import LENS, OFF_CENTRE_LENS, PARABOLA, TRIANGLE, Pulse
from rubnoise.errors import Refused
from rubnoise.inference.inference import infer_signal
from rubnoise.inference.signal import Signal
from rubnoise.record.rows import JunctionState
from rubnoise.scenario import Scenario
from rubnoise.scenario.layers import shipped
from rubnoise.scenario.reading import load
from rubnoise.theory.exact import Exact, exact
from rubnoise.theory.sizes import Function, panels
from rubnoise.theory.unit_pulse import amplitude, overlaps
from rubnoise.web_page import filled, packed, part, script_parts, web_page

EDGES: Final = (0.0, 8.0, 16.0, 24.0, 32.0)
LAGS: Final = (0.0, 0.01, 0.05, 0.2, 0.5, 0.8, 0.95, 0.99, 1.0, 1.01, 1.05, 1.2, 1.5, 1.8, 1.95, 2.0)
"""Where the series of a transform and of an overlap end: an overlap has roots at lags of 0, 1 and 2."""

_ORDERS = 5  # of the polynomials in 32/z
_FAR = np.linspace(EDGES[-1], 160.0, 401)


def tables() -> dict[str, Any]:
    """Return the table of each pulse of the page by its name, and where its series end."""
    lives = {
        "lens": _life(LENS, lambda z: amplitude(LENS, z), fall=2, root=0.5, waves=1),
        "triangle": _life(TRIANGLE, lambda z: amplitude(TRIANGLE, z), fall=2, root=0.0, waves=1),
        "parabola": _life(PARABOLA, lambda z: amplitude(PARABOLA, z), fall=2, root=0.0, waves=1),
        "offCentre": _life(OFF_CENTRE_LENS, _off_centre, fall=5, root=0.5, waves=2),
    }
    return {"edges": EDGES, "lags": LAGS, "lives": lives}


def _life(pulse: Pulse, spectrum: Function, *, fall: int, root: float, waves: int) -> dict[str, Any]:
    x, far = EDGES[-1] / _FAR, spectrum(_FAR) * _FAR**fall
    swings = [x**root * swing(n * _FAR) for n in range(1, waves + 1) for swing in (np.cos, np.sin)]
    terms = [part * x**order for part in (np.ones_like(x), *swings) for order in range(_ORDERS)]
    level, *parts = np.linalg.lstsq(np.stack(terms, axis=-1), far)[0].reshape(-1, _ORDERS)
    return {
        "lifeIntegrals": [pulse.life_integral(power) for power in (1, 2, 3)],
        "lifeMean": pulse.life_mean(),
        "meanLife": pulse.mean_life,
        "tail": pulse.tail,
        "fall": fall,
        "root": root,
        "near": _pieces(lambda z: spectrum(z) * (1.0 + z * z) ** (0.5 * fall), EDGES, 24),
        "level": _digits(level),
        "swings": [[_digits(part) for part in parts[2 * n : 2 * n + 2]] for n in range(waves)],
        "overlap": _pieces(overlaps(pulse, 1, 1), LAGS, 12),
    }


def _off_centre(phase: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the mean of |a^(z)|^2 over offsets, (pi^3/2) int_0^inf (J_1(q/2)/q)^4 dp, q^2 = z^2 + p^2."""
    place, weight = panels(np.linspace(0.0, 2000.0, 501), 12)
    across = np.hypot(np.maximum(phase, 1e-6)[:, None], place)
    return np.asarray(0.5 * np.pi**3 * (j1(0.5 * across) / across) ** 4 @ weight, dtype=np.float64)


def _pieces(curve: Function, edges: Sequence[float], degree: int) -> list[list[float]]:
    return [_digits(Chebyshev.interpolate(curve, degree, [low, high]).coef) for low, high in pairwise(edges)]


def _digits(values: Any) -> list[float]:
    return [float(f"{value:.10g}") for value in np.asarray(values, dtype=np.float64).tolist()]


# The page.
_HERE: Final = "rubnoise.lesson"
_FIRST: Final = (
    "numbers random pulses model rows theory theory_regular theory_density world piece slider load field motion flight"
    " trace run seen reading plot places stage traces"
)
_LAST: Final = "main"
"""Parts of the script that others build on come first, and the one that begins comes last."""


def page(title: str, scenario: Scenario, record: dict[str, Any] | None = None) -> str:
    """Return the text of the page for a title, a scenario, and the junctions of a run if there is one.

    It makes no requests: styles, script and data stand in it, and its policy forbids every request. Raises Refused as
    `settings_of`.
    """
    settings, borrowed = settings_of(scenario)
    data = {"title": title, **settings, "record": record, "readings": readings()}
    styles = [_short(part(_HERE, name)) for name in _names(".css")]
    missing = " and no ".join(borrowed)
    subtitle = f"The scenario has no {missing}: that of the paper's Figure 5 stands in." if missing else ""
    body = filled(
        part(_HERE, "page.html"),
        {"title": escape(title), "subtitle": escape(subtitle), "replaying": escape(record["note"] if record else "")},
    )
    scripts = [_short(text) for text in scripts_by_name().values()]
    return web_page(body, title=f"Lessons on rubbing noise: {title}", styles=styles, scripts=scripts, data=data)


def scripts_by_name() -> dict[str, str]:
    """Return the texts of the script's parts by name, in the order in which they run."""
    first = _FIRST.split()
    names = [*first, *sorted({name.removesuffix(".js") for name in _names(".js")} - {*first, _LAST}), _LAST]
    return {"tables": f"globalThis.rub = {{ tables: {json.dumps(tables())} }};"} | script_parts(_HERE, names)


def _names(ending: str) -> list[str]:
    return sorted(each.name for each in (files(_HERE) / "parts").iterdir() if each.name.endswith(ending))


def _short(text: str) -> str:
    """Return a text without the spaces at the beginning of lines, a tenth of the page."""
    return "\n".join(line.lstrip() for line in text.splitlines())


LESSON_STRENGTH: Final = 250.0
LESSON_SPEED: Final = 1000.0
LESSON_SLIDER: Final = {"mass": 0.005, "stiffness": 300.0, "damping": 0.05}
"""Strength (MPa), speed (um/s) and slider (kg, N/m, N s/m) of the paper's Figure 5, if a scenario has none."""


def settings_of(scenario: Scenario) -> tuple[dict[str, Any], tuple[str, ...]]:
    """Return the knobs of the page as a scenario sets them, with the distance of its run in um and its slider's start.

    Beside them are the tables that the scenario lacks and that were taken from the paper's Figure 5. Raises Refused for
    sizes that are neither equal nor normal, for strengths that differ, for births that are neither random nor regular,
    and for other lives than lenses off the centre line: the page cannot draw them.
    """
    model = scenario.model()
    sizes, strengths, slider, pulse = model.sizes, model.strengths, model.slider, model.pulse
    known = {
        "passes off the centre line of lenses alone (pulse.offset)": pulse.offset == "none" or pulse.shape == "lens",
        "poisson and regular births alone (birth.law)": isinstance(model.births, PoissonBirths | RegularBirths),
        "fixed and normal diameters alone (diameter.law)": isinstance(sizes, Fixed | Normal),
        "equal strengths alone (strength.law)": strengths is None or isinstance(strengths, Fixed),
    }
    for what, holds in known.items():
        if not holds:
            raise Refused(f"the page of lessons knows {what}")
    world = {
        "meanArea": model.mean_real_contact_area,
        "meanCount": model.mean_junction_count,
        "spread": sizes.std if isinstance(sizes, Normal) else 0.0,
        "births": "regular" if isinstance(model.births, RegularBirths) else "poisson",
        "pulse": pulse.shape,
        "offset": pulse.offset,
        "calibration": model.calibration,
        "speed": model.sliding_speed or LESSON_SPEED,
        "strength": LESSON_STRENGTH if strengths is None else strengths.mean,
        **({name: getattr(slider, name) for name in LESSON_SLIDER} if slider else LESSON_SLIDER),
        "seed": scenario.run.seed,
        "coupling": "two-way" if model.is_two_way else "one-way",
    }
    lacking = {"strength": strengths, "sliding.speed": model.sliding_speed, "slider": slider}
    borrowed = tuple(name for name, found in lacking.items() if found is None)
    start = slider.start if slider else "equilibrium"
    return {"world": world, "distance": model.distance, "sliderStart": start}, borrowed


LAWS: Final = ("normal", "lognormal", "exponential")  # laws of sizes, each with the scenario ``lessons/read_LAW.toml``

_FULL_SCALE: Final = 4095  # steps of a sensor of 12 bits between no force and the largest one of its trace
_CELLS: Final = 160
_LARGEST_SIZE: Final = 40.0  # um: hardly any of the swing comes from larger ones


@cache
def readings() -> tuple[dict[str, Any], ...]:
    """Return the traces for the page of lessons, as JSON can hold them.

    ``values`` are forces in steps of ``step`` uN, one every ``tick`` um. ``found`` is the diameter in um that
    `rubnoise.infer` finds in these values, with its 95 % interval, if it is given the law of sizes. The truth: the mean
    ``diameter`` at birth and the ``lag`` of the exact autocovariance's half, in um, and the ``density`` of diameters in
    1/um in the middles of even cells from 0 to ``largest`` um.
    """
    return tuple(_reading(law) for law in LAWS)


def _reading(law: str) -> dict[str, Any]:
    scenario = load(shipped(f"lessons/read_{law}.toml"), ["run.engine=batch"])
    model, force = scenario.model(), simulate(scenario).trace["friction_force"][:]
    step, theory = float(force.max()) / _FULL_SCALE, exact(model)
    values = np.rint(force / step).astype(np.uint16)
    signal = Signal(values=np.asarray(values * step, dtype=np.float64), tick=model.tick, unit="uN", scale=1.0)
    found = infer_signal(signal, zero="known", law=law, tests=False).estimates["diameter"]
    # The last digits of a fit depend on how many threads add its matrices; a page has the same bytes each time.
    value, low, high = (float(f"{each:.6g}") for each in (found.value, *found.interval))
    middles = np.asarray((np.arange(_CELLS) + 0.5) * (_LARGEST_SIZE / _CELLS), dtype=np.float64)
    return {
        "law": law,
        "tick": model.tick,
        "step": step,
        "values": packed(values),
        "found": {"diameter": value, "interval": [low, high]},
        "diameter": theory.mean_diameter,
        "lag": half_lag(theory),
        "largest": _LARGEST_SIZE,
        "density": [float(f"{value:.4g}") for value in model.sizes.density(middles).tolist()],
    }


def half_lag(theory: Exact) -> float:
    """Return the lag in um at which the exact autocovariance of the area has fallen to one half."""
    half = 0.5 * float(theory.autocovariance(0.0))
    return float(brentq(lambda lag: float(theory.autocovariance(lag)) - half, 0.0, 20.0 * theory.mean_diameter))


_MOST_ROWS: Final = 50_000  # junctions that go into a page: two megabytes with their strengths


def record_of(run: Run) -> dict[str, Any]:
    """Return the junctions of a run as base64 of little-endian doubles, its tick, and their end in um.

    A longer run is cut where the first junction is born that does not fit; ``note`` says so in words.
    """
    junctions, model = run.groups()["junctions"], run.model()
    rows = min(len(junctions), _MOST_ROWS)
    note = f"This is {run.path.name}, seed {run.scenario.run.seed}: its junctions, row by row."
    distance = model.distance
    if rows < len(junctions):
        distance = float(junctions["birth_distance"][rows])
        note += f" Of {model.distance:g} um the page holds the first {distance:g}, {rows} junctions."
    names = {
        "birth": "birth_distance",
        "diameter": "diameter",
        "strength": "shear_strength",
        "offset": "lateral_offset",
    }
    if np.any(junctions["state"][:rows] & JunctionState.ENDED_EARLY):  # by an intervention
        names["death"] = "death_distance"
    return {
        "tick": model.tick,
        "distance": distance,
        "note": f"{note} A control of the contact leaves it for a run of the page's own; reset brings it back.",
        **{name: packed(junctions[column][:rows]) for name, column in names.items() if column in junctions},
    }
