"""Problems and warnings of a scenario whose keys are all valid: plausibility, ticks, calibration, cost."""

from collections.abc import Collection
from dataclasses import replace
from typing import Any, Final

from rubnoise.contact.births import ScatteredBirths
from rubnoise.contact.calibration import Uncalibrated
from rubnoise.contact.pulses import pulse_of
from rubnoise.model import Model
from rubnoise.scenario.document import AREAS, COUNTS, LIVE_JUNCTIONS, SECTIONS, Diameter, Document, Strength
from rubnoise.scenario.fields import Measure, keys_of
from rubnoise.scenario.scenario import area_and_count, default_tick, diameter_of, model_of, spread_of
from rubnoise.scenario.text import Layers, Problem
from rubnoise.units import Quantity, QuantityError, read_quantity

RESULT_ROWS: Final = 2_000_000_000
_FEW_ASPERITIES = 0.3
_MOST_SPACINGS = 1e4

MOST_LIVE = 1000.0  # junctions in contact up to which free motion is computed; with more, a single one has no effect
COARSE = 0.3  # turn of the contact resonance in a tick, in rad, beyond which there is a warning


def modelled(
    document: Document, layers: Layers, wrong: Collection[str]
) -> tuple[Model | None, Quantity | None, list[Problem]]:
    """Return the model and its tick, None if there is none; and all problems that can be seen in it.

    In place of a ``wrong`` table stands its default: no check that needs it is made.
    """
    checks = _Checks(document, layers, wrong)
    model, tick = checks.model()
    return model, tick, checks.found


class _Checks:
    """The checks of a document, each of which says what it finds."""

    def __init__(self, document: Document, layers: Layers, wrong: Collection[str]) -> None:
        self.document, self.layers, self.wrong = document, layers, set(wrong)
        self.found: list[Problem] = []
        default = " (by default a two-hundredth of the mean life; set output.tick)"
        self.where_from = "" if document.output.tick else default

    def say(self, key: str, message: str, hint: str = "", **how: Any) -> None:
        self.found.append(replace(self.layers.problem(tuple(key.split(".")), message, hint), **how))

    def model(self) -> tuple[Model | None, Quantity | None]:
        """Return the model and its tick; None for both as soon as there can be none."""
        document, given = self.document, self.document.output.tick
        self.plausibility()
        self.excitation()
        if document.strength:
            self.width("strength", document.strength, float(document.strength.mean))
        if given and "sliding" not in self.wrong:
            self.distance(given)
        if "interface" in self.wrong or not self.contact() or {"diameter", "pulse"} & self.wrong:
            return None, None
        try:
            diameter = diameter_of(document)
        except Uncalibrated as error:
            self.say(f"interface.{error.key}", str(error), error.hint)
            return None, None
        has_length, tick = not {"sliding", "output"} & self.wrong, given or default_tick(diameter)
        life = pulse_of(document.pulse.shape, document.pulse.offset).mean_life * diameter
        if tick > life:
            message = f"longer than the mean life of a junction ({life:.6g} um); a trace would miss whole lives"
            self.say("output.tick", message, f'about "{life / 200.0:.2g} um" resolves a life well')
        if has_length and not given:
            self.distance(tick)
        if not self.width("diameter", document.diameter, diameter):
            return None, None
        model = model_of(document, diameter, tick)
        self.births(model)
        if has_length:
            self.cost(model)
            self.resonance(model)
        return model, tick

    def plausibility(self) -> None:
        """Warn of quantities so far from any real contact that a typing error is likely."""
        for name, section in SECTIONS.items():
            for key, about in keys_of(section).items():
                value, measure = getattr(getattr(self.document, name), key, None), about.kind
                if isinstance(value, Quantity) and isinstance(measure, Measure) and value not in measure.plausible:
                    size = "large" if value > measure.plausible.high else "small"
                    message = f"implausibly {size} ({value.kind.number(value)})"
                    self.say(f"{name}.{key}", message, _other_prefix(value, measure), severity="warning")

    def excitation(self) -> None:
        """Refuse excitations without a run, heights without equal sizes, and sums of asperities that are not wanted.

        A base is lifted by triangles: with lives of another shape only theory knows it.
        """
        document, slider = self.document, self.document.slider
        if slider is None or slider.excitation in {None, "friction"}:
            return
        of_base = slider.excitation == "base"
        if not of_base or (document.pulse.shape != "triangle" and "pulse" not in self.wrong):
            why, hint = (" of such lives", 'pulse.shape = "triangle"') if of_base else ("", "")
            message = f'the excitation "{slider.excitation}"{why} has no run: rubnoise theory works it out'
            self.say("slider.excitation", message, hint, forbids_run=True)
        if of_base and document.diameter.law != "fixed":
            message = "excitation by the base is known for equal diameters alone"
            self.say("slider.excitation", message, 'diameter.law = "fixed"')
        count = 0.0 if "interface" in self.wrong else area_and_count(document)[1]
        if of_base and count > _FEW_ASPERITIES and slider.heights != "sum":
            message = f"{count:g} asperities at once: a rigid body rides on the highest"
            hint = f'at most {_FEW_ASPERITIES:g}, or slider.heights = "sum" if sums are wanted'
            self.say("interface.mean_junction_count", message, hint)

    def contact(self) -> bool:
        """Refuse an area or a count beyond what a scenario may give, and many junctions under a free slider."""
        (area, count), load, before = area_and_count(self.document), self.document.load, len(self.found)
        patches = "mean_junction_count" if self.document.interface.patch_area is None else "patch_area"
        derived = (("load", area, AREAS, "um^2 of real contact area"), ("patch_area", count, COUNTS, "junctions"))
        for key, value, possible, what in derived:
            if value not in possible:
                bounds = f"{possible.low:g} to {possible.high:g}"
                self.say(f"interface.{key}", f"gives {value:.3g} {what}; possible: {bounds}")
        if load is not None and load.motion == "free" and count > MOST_LIVE:
            message = f"{count:.3g} junctions in contact: free motion is computed up to {MOST_LIVE:g}"
            hint = 'load.motion = "first-order", which is right for so many'
            self.say(f"interface.{patches}", message, hint)
        return len(self.found) == before

    def distance(self, tick: Quantity) -> None:
        distance = self.document.sliding.distance
        if tick.exact > distance.exact:
            message = "the tick is longer than the distance: only the start would be written"
            hint = f'distance "{distance.as_text()}", tick "{tick.as_text()}"{self.where_from}'
            self.say("sliding.distance" if self.where_from else "output.tick", message, hint)

    def width(self, table: str, quantity: Diameter | Strength, centre: float) -> bool:
        """Refuse laws with a long tail that are wider than their numerics allow; the normal law has no limit."""
        spread = spread_of(quantity)
        ratio, widest = spread.std(centre) / centre, spread.entry.widest
        too_wide = ratio > widest * (1.0 + 1e-12)
        if too_wide:
            message = f'{ratio:.4g} times the mean is too wide for the law "{quantity.law}"'
            self.say(f"{table}.spread", message, f'up to "{100.0 * widest:g} %"')
        return not too_wide

    def births(self, model: Model) -> None:
        """Refuse lives so long that memory cannot hold the junctions, and clusters that need most births of the run."""
        alive, births = model.mean_live_junctions, model.births
        if alive > LIVE_JUNCTIONS:
            message = f"{alive:.3g} junctions alive at once expected; at most {LIVE_JUNCTIONS:.0e}"
            hint = "fewer junctions or a smaller diameter.spread"
            self.say("interface.mean_junction_count", message, hint, forbids_run=True)
        if isinstance(births, ScatteredBirths) and "birth" not in self.wrong:
            spacings = births.width / births.mean_spacing
            if spacings > _MOST_SPACINGS:
                message = f"{births.width:.3g} um is {spacings:.3g} mean spacings of births"
                self.say("birth.cluster_width", message, f"at most {_MOST_SPACINGS:g} spacings")

    def cost(self, model: Model) -> None:
        """Refuse runs too large for any disk, from expected numbers, before drawing any."""
        # Those alive at the start are at most a two-thousandth of the limit (`births`).
        junctions, ticks = model.birth_rate * model.distance, model.tick_count + 1
        if junctions + ticks > RESULT_ROWS:
            expected = f"{junctions:.3g} junctions and {float(ticks):.3g} ticks expected"
            hint = f"make sliding.distance shorter or output.tick longer{self.where_from}"
            message = f"too long a run: {expected}; at most {RESULT_ROWS:.0e} rows"
            self.say("sliding.distance", message, hint, forbids_run=True)

    def resonance(self, model: Model) -> None:
        if model.separation is None or model.tick_duration is None:
            return
        turned = model.separation.oscillator.natural_angular_frequency * model.tick_duration
        if turned > COARSE:
            message = f"the contact resonance turns by {turned:.3g} rad in a tick: exact, but coarsely sampled"
            hint = f'about "{COARSE * model.tick / turned:.2g} um" shows it well{self.where_from}'
            self.say("output.tick", message, hint, severity="warning")


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
