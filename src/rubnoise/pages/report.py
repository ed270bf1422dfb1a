"""Reports of a run, a sweep or two surfaces: words, figures beside exact values, pictures, sound and origin."""

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from html import escape
from io import BytesIO
from math import isfinite
from typing import Any, Final

import numpy as np

from rubnoise.analysis.moments import one_way_warnings
from rubnoise.analysis.motion import Flights
from rubnoise.analysis.sound import Sound
from rubnoise.answer import length
from rubnoise.api.running import simulate
from rubnoise.api.sweep_result import SweepResult
from rubnoise.arrays import Doubles
from rubnoise.errors import ExtraMissing, Refused
from rubnoise.figure_names import STATES
from rubnoise.figures import Figure, Kind
from rubnoise.figures.catalogue import drawing, sweep_drawing
from rubnoise.figures.fits import contact_figure
from rubnoise.figures.study import key_label, quantities_of, quantity_words
from rubnoise.figures.style import as_bytes
from rubnoise.figures.tracks import Stretch
from rubnoise.model import Model
from rubnoise.pages.page import last_time
from rubnoise.record.rows import Reader
from rubnoise.scenario import loads
from rubnoise.scenario.text import text_of
from rubnoise.storage.sound import write_wave
from rubnoise.surface.sliding import SlidingContact
from rubnoise.tables import as_html
from rubnoise.web_page import coded, report_page


def in_words(stretch: Stretch, measured: Mapping[str, Any]) -> list[str]:
    """Return sentences about a run and its model; numbers stand in the table below them."""
    model = stretch.model
    return [*_contact(model), *_driven(model), *_flights(stretch), *_motion(model, measured)]


def _contact(model: Model) -> Iterator[str]:
    """Yield what slides, and what the contact is made of."""
    way, free = length(model.distance, 4).replace("um", "µm"), model.free
    if free is not None:
        yield (
            f"A slider of {1000.0 * free.held.mass:.4g} g slides over {way} of a rough surface under its load of"
            f" {1e-6 * free.held.load:.4g} N. It may leave the surface and fall back on it."
        )
        if free.restitution is None:
            yield "An overlap pushes harder while it grows and less while it shrinks (Hunt and Crossley)."
        else:
            yield (
                f"An overlap that shrinks pushes with {free.restitution**2:.3g} times the force of one that grows"
                f" (restitution {free.restitution:.3g})."
            )
        return
    centred = model.pulse.offset == "none"
    yield (
        f"Two rough surfaces slide over {way}. Where their asperities meet, junctions are born, grow to a"
        f" {'full' if centred else 'largest'} overlap, shrink and die."
    )
    yield (
        f"On average {model.mean_junction_count:.4g} junctions live at once. One is born every"
        f" {model.mean_birth_spacing:.4g} µm of sliding, and each lives for about {model.mean_life_distance:.4g} µm."
    )
    yield (
        f"The area of a junction rises and falls as a {model.pulse.shape}. The areas of all live junctions add up to"
        " the real contact area."
    )
    if not centred:
        yield (
            "The centres of two asperities miss each other by a lateral offset, anything up to the diameter on either"
            " side. The larger the offset, the shorter the life and the smaller the area."
        )


def _driven(model: Model) -> Iterator[str]:
    """Yield what the contact drives, and what carries the load."""
    if model.strengths is not None:
        borne = "area" if model.separation is None else "load on the junctions over their hardness"
        yield f"The friction force is the {borne} times the shear strength."
    lifted = model.slider is not None and model.slider.excitation == "base"
    if lifted:
        yield "Asperities lift the slider: it moves normal to the surfaces."
    elif model.separation is not None:
        yield "The slider rests on its load, and rises and falls with the resonance of its contact."
    elif model.free is None:
        yield "The separation of the surfaces is held, so that the load varies as the area does."
    if model.slider is not None:
        coupling = "one-way: the surfaces slide at constant speed, however the slider moves"
        if model.is_two_way:
            coupling = "two-way: the motion of the slider changes how fast the surfaces slide"
        driven = "A base that asperities lift" if lifted else "The force"
        yield f"{driven} moves a slider on a spring. The coupling is {coupling}."


def _flights(stretch: Stretch) -> Iterator[str]:
    """Yield how long a slider was off the surface, how often it fell on it, and the largest speed of an overlap."""
    if stretch.has_theory or stretch.file.rows("load") < 2:
        return
    end = last_time(stretch.file, "load")
    found = Flights.of(stretch.file, 0.0, end)
    if not found.impacts.size:
        yield "It never fell on the surface."
        return
    yield (
        f"It was off the surface for {100.0 * found.share(0.0, end):.3g} % of the time, and fell on it"
        f" {found.impacts.size / end:.3g} times a second. At the hardest impact an overlap grew at"
        f" {1e-3 * float(found.speeds.max()):.3g} mm/s, by sliding and falling together."
    )


def _motion(model: Model, measured: Mapping[str, Any]) -> Iterator[str]:
    """Yield what the measured motion says: whether one-way coupling holds, or how the slider sticks."""
    if "one_way_validity" in measured and model.slider is not None and model.slider.excitation != "base":
        validity = measured["one_way_validity"]
        fair = f"the velocity of the slider spreads by {validity:.3g} times the sliding speed, which is little"
        said = [*one_way_warnings(model, validity), fair][0]
        yield f"{said[:1].upper()}{said[1:]}."
    if "stick_fraction" in measured:
        yield (
            f"The slider moves with the drive, stuck to the surface, for {100.0 * measured['stick_fraction']:.3g} % of"
            f" the time. It sticks {measured['sticks_per_s']:.3g} times a second. Each time it then breaks away and"
            " slips."
        )


# Reports.
CAPTIONS: Final[dict[Kind, str]] = {
    "trace": "Real contact area over the sliding distance, at the beginning of the run.",
    "lives": "Single junctions: above, their areas add up to the real contact area; below, each by itself.",
    "histogram": "How often each area occurs.",
    "psd": "Spectrum of the real contact area.",
    "acf": "Autocovariance of the real contact area.",
    "count": "How many junctions live at once.",
    "slider": "Motion of the slider at the beginning of the run.",
    "phase": "Velocity of the slider over its displacement.",
    "landmarks": "How far the slider slips and how long it sticks, or how fast it falls and how long it flies.",
    "lifelines": "A bar for each life from birth to death, or for each touch of a summit.",
    "load": "Load, separation and normal velocity at the beginning of the run.",
}
IN_COLOURS: Final = (
    "Blue, grey and black are simulated. What theory knows of this run is orange: means, with a band of one standard"
    " deviation on each side, laws and spectra."
)

SECONDS: Final = 5.0
RATE: Final = 44_100
"""Length of the sound in s at most, and samples a second."""

Between = Callable[[], None]


def run_report(file: Reader, text: str, between: Between) -> str:
    """Return the report of a finished run with the text of its numbers; ``between`` is called and may raise to stop.

    Parts that a run does not have, such as a sound without a slider, are left out. Raises ExtraMissing without
    matplotlib.
    """
    stretch, origin = Stretch.of(file), file.provenance
    sections = {
        "What was simulated": _paragraphs(in_words(stretch, file.summary)),
        "In numbers": _as_it_is(text),
        "Pictures": _paragraphs([IN_COLOURS]) + "".join(_pictures(stretch, between)),
        "Sound": _sound(file, between),
        "Scenario": _as_it_is(text_of(json.loads(str(origin["scenario_resolved"])))),
        "How to repeat this run": _repeat("rubnoise run scenario.toml -o run.h5", {**file.attributes, **origin}),
    }
    return report_page(str(file.attributes["title"]) or file.path.stem, sections, str(origin["finished"]))


def sweep_report(sweep: SweepResult, between: Between) -> str:
    """Return the report of a sweep, finished or not; ``between`` is called between its parts and may raise to stop."""
    quantities, origin = quantities_of(sweep.index), sweep.attributes
    if not quantities or not sweep.count("done"):
        raise Refused("no run of this sweep is done yet; there is nothing to report")
    states = ", ".join(f"{sweep.count(state):,} {state}" for state in STATES if sweep.count(state))
    swept = ", ".join(key_label(key, sweep.runs[key].units) for key in sweep.keys)
    sections = {
        "What was simulated": _paragraphs([f"{len(sweep.points):,} points over {swept}.", f"Runs: {states}."]),
        "Pictures": "".join(_studies(sweep, quantities, between)),
        "Every point": _points(sweep, quantities),
        "Failed runs": _paragraphs([f"{run.run_id}: {run.reason}" for run in sweep.failures]),
        "Scenario": _as_it_is(str(origin["scenario_toml"])),
        "How to repeat this sweep": _repeat("rubnoise sweep scenario.toml -o folder", origin),
    }
    return report_page(sweep.title or sweep.path.name, sections, str(origin["written"]))


def _paragraphs(sentences: Sequence[str]) -> str:
    return "".join(f"<p>{escape(sentence)}</p>" for sentence in sentences)


def _as_it_is(text: str) -> str:
    return f"<pre>{escape(text)}</pre>"


def _picture(caption: str, draw: Callable[..., Figure], *of: Any, **how: Any) -> str:
    """Return what a function draws, with a caption; nothing of a run that does not have it."""
    try:
        content = as_bytes(draw(*of, **how))
    except ExtraMissing:
        raise
    except Refused:
        return ""
    text = escape(caption, quote=True)
    image = f'<img alt="{text}" src="data:image/png;base64,{coded(content)}">'
    return f"<figure>{image}<figcaption>{text}</figcaption></figure>"


def _pictures(stretch: Stretch, between: Between) -> Iterator[str]:
    for name, caption in CAPTIONS.items():
        between()
        yield _picture(caption, drawing, name, stretch)
        if name == "histogram" and not stretch.has_theory:
            yield _picture("How often each load occurs.", drawing, name, stretch, heard="load")


def _studies(sweep: SweepResult, quantities: Sequence[str], between: Between) -> Iterator[str]:
    for quantity in quantities:
        between()
        words = quantity_words(quantity)
        caption = f"{words[:1].upper()}{words[1:]}, with 95 % intervals and the exact curve."
        yield _picture(caption, sweep_drawing, sweep.index, sweep.name, quantity)


def _points(sweep: SweepResult, quantities: Sequence[str]) -> str:
    """Return a table of every point: the swept values, and each quantity with half the width of its 95 % interval."""
    columns = [[str(values[key]) for values in sweep.values] for key in sweep.keys]
    for quantity in quantities:
        known = ((pooled.value, pooled.reach) for pooled in sweep.estimates(quantity))
        columns.append([f"{value:.5g}" + (f" ± {reach:.2g}" if isfinite(reach) else "") for value, reach in known])
    heading = [*(key.rpartition(".")[2].replace("_", " ") for key in sweep.keys), *map(quantity_words, quantities)]
    return f'<div class="scrolled">{as_html("", heading, zip(*columns, strict=True))}</div>'


def _repeat(command: str, origin: Mapping[str, object]) -> str:
    """Return what makes the same numbers again, and what made these."""
    software = json.loads(str(origin.get("software", "{}")))
    facts = {
        "written by": origin["source"],
        "command": origin["command"],
        "seed": origin.get("seed"),
        "software": ", ".join(f"{name} {version}" for name, version in software.items()) or None,
    }
    known = ((name, str(fact)) for name, fact in facts.items() if fact is not None)
    listed = "".join(f"<dt>{escape(name)}</dt><dd>{escape(fact)}</dd>" for name, fact in known)
    words = "Save the scenario above as scenario.toml. This command makes the same numbers again, to the bit:"
    return f"{_paragraphs([words])}{_as_it_is(command)}<dl>{listed}</dl>"


def _sound(file: Reader, between: Between) -> str:
    try:
        sound = Sound.of(file, "velocity", rate=RATE, speed_up=1.0)
        sound = sound.lasting(min(SECONDS, sound.seconds))
        full_scale = sound.full_scale
    except Refused:
        return ""
    what = "velocity of the slider" if sound.group == "slider" else "normal velocity of the slider"
    words = f"The {what}, {sound.seconds:.3g} s of it, as fast as it happened."
    return _heard(words, sound.pieces(full_scale, between), sound.samples)


def _heard(words: str, pieces: Iterable[Doubles], samples: int) -> str:
    """Return words and what plays samples from -1 to 1, which come in pieces."""
    stream = BytesIO()
    write_wave(stream, pieces, samples=samples, rate=RATE, texts={})
    return f'{_paragraphs([words])}<audio controls src="data:audio/wav;base64,{coded(stream.getvalue())}"></audio>'


SECONDS_OF_AREA: Final = 3.0
SAMPLES_A_LIFE: Final = 100
"""Samples for a mean life of junctions: the noise then falls off above about 300 Hz."""

FEWEST_SAMPLES: Final = 4
_PEAK: Final = 0.7


def surface_report(contact: SlidingContact, text: str, **scenario: Any) -> str:
    """Return the page: the text of the command, five panes, the sound of the area, and the scenario as it is written.

    ``scenario`` are the keywords of `SlidingContact.scenario_text`. Raises ExtraMissing without matplotlib.
    """
    shown = "Both height maps with patches of contact, bearing curve, spectra, number of junctions over the cut-off,"
    sections = {
        "In numbers": _as_it_is(text),
        "Pictures": _picture(f"{shown} autocovariance", contact_figure, contact),
        "Sound": _sound_of_area(contact, scenario.get("speed")),
        "Scenario": _as_it_is(contact.scenario_text(**scenario)),
    }
    return report_page(f"{contact.slider.name} on {contact.track.name}", sections)


def _sound_of_area(contact: SlidingContact, speed: float | None) -> str:
    """Return words and the sound of the scenario's area less its mean at a speed in um/s.

    Without a speed it is one that is well heard; one at which lives are shorter than a few samples is slowed down.
    """
    life = contact.scenario.model().mean_life_distance
    tick = life / SAMPLES_A_LIFE if speed is None else min(speed / RATE, life / FEWEST_SAMPLES)
    samples = int(SECONDS_OF_AREA * RATE)
    text = contact.scenario_text(distance=samples * tick)
    record = simulate(loads(f'{text}\n[output]\ntick = "{tick:.9g} um"\n\n[run]\nengine = "batch"\n', "surface"))
    area = np.asarray(record.trace["real_contact_area"][:samples], dtype=np.float64)
    values = area - area.mean()
    values *= _PEAK / np.abs(values).max()
    heard = f"at a sliding speed of {tick * RATE * 1e-3:.3g} mm/s"
    return _heard(f"The real contact area of the scenario as it changes {heard}.", [values], values.size)
