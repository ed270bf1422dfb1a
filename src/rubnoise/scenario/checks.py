"""Problems and warnings of a scenario whose keys are all valid: plausibility, ticks, calibration, cost."""

from collections.abc import Collection, Iterator
from dataclasses import replace
from typing import Final

from rubnoise.contact.births import ScatteredBirths
from rubnoise.contact.calibration import Uncalibrated
from rubnoise.contact.pulses import pulse_of
from rubnoise.model import Model
from rubnoise.scenario.document import AREAS, COUNTS, LIVE_JUNCTIONS, SECTIONS, Diameter, Document, Strength
from rubnoise.scenario.fields import Measure, keys_of
from rubnoise.scenario.scenario import area_and_count, default_tick, diameter_of, model_of, spread_of
from rubnoise.scenario.text import Layers, Path, Problem
from rubnoise.units import Quantity, QuantityError, read_quantity

_DISTANCE: Path = ("sliding", "distance")
_TICK: Path = ("output", "tick")
_PATCH: Path = ("interface", "patch_area")
RESULT_ROWS: Final = 2_000_000_000
_FEW_ASPERITIES = 0.3
_EXCITATION: Path = ("slider", "excitation")
_MOST_SPACINGS = 1e4
_COUNT: Path = ("interface", "mean_junction_count")

MOST_LIVE = 1000.0
"""Junctions in contact up to which free motion is computed; with more, a single one has no effect."""

COARSE = 0.3
"""Turn of the contact resonance in a tick, in rad, beyond which there is a warning."""


def plausibility(document: Document, layers: Layers) -> Iterator[Problem]:
    """Warn of quantities so far from any real contact that a typing error is likely."""
    for name, section in SECTIONS.items():
        for key, about in keys_of(section).items():
            value, measure = getattr(getattr(document, name), key, None), about.kind
            if isinstance(value, Quantity) and isinstance(measure, Measure) and value not in measure.plausible:
                size = "large" if value > measure.plausible.high else "small"
                message = f"implausibly {size} ({value.kind.number(value)})"
                yield replace(layers.problem((name, key), message, _other_prefix(value, measure)), severity="warning")


def _other_prefix(value: Quantity, measure: Measure) -> str:
    """Suggest another prefix, such as MPa for mPa, if that would be plausible."""
    number, _, unit = value.written.partition(" ")
    for milli, mega in (("m", "M"), ("M", "m")):
        if unit.startswith(milli):
            other = f"{number} {mega}{unit[1:]}"
            try:
                if read_quantity(other, *measure.kinds) in measure.plausible:
                    return f'did you mean "{other}"?'
            except QuantityError:
                continue
    return ""


def modelled(
    document: Document, layers: Layers, wrong: Collection[str] = ()
) -> tuple[Model | None, Quantity | None, list[Problem]]:
    """Return the model and its tick, None if there is none; and all problems that can be seen in it.

    In place of a ``wrong`` table stands its default: no check that needs it is made.
    """
    problems = [*plausibility(document, layers), *_excitation_problems(document, layers, wrong)]
    if document.strength:
        problems += _width_problems(layers, "strength", document.strength, float(document.strength.mean))
    if document.output.tick and "sliding" not in wrong:
        problems += _distance_problems(document, layers, document.output.tick)
    if "interface" in wrong:
        return None, None, problems
    impossible = [*_contact_problems(document, layers), *_free_problems(document, layers)]
    if impossible or {"diameter", "pulse"} & set(wrong):
        return None, None, [*problems, *impossible]
    try:
        diameter = diameter_of(document)
    except Uncalibrated as error:
        return None, None, [*problems, layers.problem(("interface", error.key), str(error), error.hint)]
    has_length = not {"sliding", "output"} & set(wrong)
    tick = document.output.tick or default_tick(diameter)
    problems += _tick_problems(document, layers, tick, diameter)
    if has_length and not document.output.tick:
        problems += _distance_problems(document, layers, tick)
    if too_wide := list(_width_problems(layers, "diameter", document.diameter, diameter)):
        return None, None, [*problems, *too_wide]
    model = model_of(document, diameter, tick)
    problems += _crowd_problems(layers, model)
    if "birth" not in wrong:
        problems += _cluster_problems(layers, model)
    if has_length:
        problems += [*_cost_problems(document, layers, model), *_resonance_problems(document, layers, model)]
    return model, tick, problems


def _resonance_problems(document: Document, layers: Layers, model: Model) -> Iterator[Problem]:
    if model.separation is None or model.tick_duration is None:
        return
    natural = model.separation.oscillator.natural_angular_frequency
    turned = natural * model.tick_duration
    if turned > COARSE:
        message = f"the contact resonance turns by {turned:.3g} rad in a tick: exact, but coarsely sampled"
        finer = COARSE * model.tick / turned
        hint = f'about "{finer:.2g} um" shows it well' + _where_from(document)
        yield replace(layers.problem(_TICK, message, hint), severity="warning")


def _contact_problems(document: Document, layers: Layers) -> Iterator[Problem]:
    """Refuse a load or a patch whose area or count is outside of the range that a scenario may give."""
    area, count = area_and_count(document)
    derived = ((("interface", "load"), area, AREAS, "um^2 of real contact area"), (_PATCH, count, COUNTS, "junctions"))
    for path, value, possible, what in derived:
        if value not in possible:
            yield layers.problem(path, f"gives {value:.3g} {what}; possible: {possible.low:g} to {possible.high:g}")


def _excitation_problems(document: Document, layers: Layers, wrong: Collection[str]) -> Iterator[Problem]:
    """Refuse excitations without a run, heights without equal sizes, and sums of asperities without `heights = "sum"`.

    A base is lifted by triangles: with lives of another shape only theory knows it.
    """
    slider = document.slider
    if slider is None or slider.excitation in {None, "friction"}:
        return
    if slider.excitation != "base" or (document.pulse.shape != "triangle" and "pulse" not in wrong):
        why, hint = ("", "") if slider.excitation != "base" else (" of such lives", 'pulse.shape = "triangle"')
        message = f'the excitation "{slider.excitation}"{why} has no run: rubnoise theory works it out'
        yield replace(layers.problem(_EXCITATION, message, hint), forbids_run=True)
    if slider.excitation == "base" and document.diameter.law != "fixed":
        message = "excitation by the base is known for equal diameters alone"
        yield layers.problem(_EXCITATION, message, 'diameter.law = "fixed"')
    count = 0.0 if "interface" in wrong else area_and_count(document)[1]
    if slider.excitation == "base" and count > _FEW_ASPERITIES and slider.heights != "sum":
        message = f"{count:g} asperities at once: a rigid body rides on the highest"
        hint = f'at most {_FEW_ASPERITIES:g}, or slider.heights = "sum" if sums are wanted'
        yield layers.problem(_COUNT, message, hint)


def _cluster_problems(layers: Layers, model: Model) -> Iterator[Problem]:
    """Refuse clusters so wide that any stretch of births needs most births of the run."""
    births = model.births
    if isinstance(births, ScatteredBirths) and births.width > _MOST_SPACINGS * births.mean_spacing:
        message = f"{births.width:.3g} um is {births.width / births.mean_spacing:.3g} mean spacings of births"
        yield layers.problem(("birth", "cluster_width"), message, f"at most {_MOST_SPACINGS:g} spacings")


def _free_problems(document: Document, layers: Layers) -> Iterator[Problem]:
    """Refuse a free slider on so many junctions that it never leaves them."""
    if document.load is None or document.load.motion != "free":
        return
    _, count = area_and_count(document)
    if count > MOST_LIVE:
        message = f"{count:.3g} junctions in contact: free motion is computed up to {MOST_LIVE:g}"
        hint = 'load.motion = "first-order", which is right for so many'
        yield layers.problem(_COUNT if document.interface.patch_area is None else _PATCH, message, hint)


def _tick_problems(document: Document, layers: Layers, tick: Quantity, diameter: float) -> Iterator[Problem]:
    life = pulse_of(document.pulse.shape, document.pulse.offset).mean_life * diameter
    if tick > life:
        message = f"longer than the mean life of a junction ({life:.6g} um); a trace would miss whole lives"
        yield layers.problem(_TICK, message, f'about "{life / 200.0:.2g} um" resolves a life well')


def _distance_problems(document: Document, layers: Layers, tick: Quantity) -> Iterator[Problem]:
    distance = document.sliding.distance
    if tick.exact > distance.exact:
        path = _TICK if document.output.tick else _DISTANCE
        message = "the tick is longer than the distance: only the start would be written"
        hint = f'distance "{distance.as_text()}", tick "{tick.as_text()}"' + _where_from(document)
        yield layers.problem(path, message, hint)


def _width_problems(layers: Layers, table: str, quantity: Diameter | Strength, centre: float) -> Iterator[Problem]:
    """Refuse laws with a long tail that are wider than their numerics allow; the normal law has no limit."""
    spread = spread_of(quantity)
    ratio, widest = spread.std(centre) / centre, spread.entry.widest
    if ratio > widest * (1.0 + 1e-12):
        message = f'{ratio:.4g} times the mean is too wide for the law "{quantity.law}"'
        yield layers.problem((table, "spread"), message, f'up to "{100.0 * widest:g} %"')


def _where_from(document: Document) -> str:
    return "" if document.output.tick else " (by default a two-hundredth of the mean life; set output.tick)"


def _crowd_problems(layers: Layers, model: Model) -> Iterator[Problem]:
    """Refuse a contact in which drawing again makes lives so long that memory cannot hold the junctions."""
    alive = model.mean_live_junctions
    if alive > LIVE_JUNCTIONS:
        message = f"{alive:.3g} junctions alive at once expected; at most {LIVE_JUNCTIONS:.0e}"
        hint = "fewer junctions or a smaller diameter.spread"
        yield replace(layers.problem(_COUNT, message, hint), forbids_run=True)


def _cost_problems(document: Document, layers: Layers, model: Model) -> Iterator[Problem]:
    """Refuse runs too large for any disk, from expected numbers, before drawing any."""
    # Those alive at the start are at most a two-thousandth of the limit (`_crowd_problems`).
    junctions = model.birth_rate * model.distance
    ticks = model.tick_count + 1
    if junctions + ticks <= RESULT_ROWS:
        return
    message = (
        f"too long a run: {junctions:.3g} junctions and {float(ticks):.3g} ticks expected; "
        f"at most {RESULT_ROWS:.0e} rows"
    )
    hint = f"make sliding.distance shorter or output.tick longer{_where_from(document)}"
    yield replace(layers.problem(_DISTANCE, message, hint), forbids_run=True)
