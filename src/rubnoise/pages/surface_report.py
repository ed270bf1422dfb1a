"""A report of two surfaces: one page with the answers, the maps and curves, the scenario, and its sound."""

from html import escape
from typing import Any, Final

import numpy as np

from rubnoise.api.running import simulate
from rubnoise.figures.surface import contact_picture
from rubnoise.pages.page import written
from rubnoise.scenario import loads
from rubnoise.storage.wave_file import write_wave
from rubnoise.surface.sliding import SlidingContact
from rubnoise.web_page import coded, part, web_page

RATE: Final = 44_100
SECONDS: Final = 3.0
SAMPLES_A_LIFE: Final = 100
"""Samples for a mean life of junctions: the noise then falls off above about 300 Hz."""

FEWEST_SAMPLES: Final = 4
_PEAK: Final = 0.7


def surface_report(contact: SlidingContact, text: str, **scenario: Any) -> str:
    """Return the page: the text of the command, five panes, the sound of the area, and the scenario as it is written.

    ``scenario`` are the keywords of `SlidingContact.scenario_text`. Raises PicturesMissing without matplotlib.
    """
    title = f"{contact.slider.name} on {contact.track.name}"
    image = coded(contact_picture(contact))
    alt = "Both height maps with patches of contact, bearing curve, spectra, number of junctions over the cut-off,"
    sound, words = _sound(contact, scenario.get("speed"))
    body = (
        f"<main><h1>{escape(title)}</h1><pre>{escape(text)}</pre>"
        f'<figure><img alt="{alt} autocovariance" src="data:image/png;base64,{image}"></figure>'
        f'<section class="on-screen"><h2>Sound</h2><p>{escape(words)}</p>'
        f'<audio controls src="data:audio/wav;base64,{sound}"></audio></section>'
        f"<h2>Scenario</h2><pre>{escape(contact.scenario_text(**scenario))}</pre></main>"
    )
    return web_page(body, title=title, styles=[part("rubnoise.figures", "report.css")])


def _sound(contact: SlidingContact, speed: float | None) -> tuple[str, str]:
    """Return a WAV file in base 64 of the scenario's area less its mean at a speed in um/s, and words with the speed.

    Without a speed it is one that is well heard; one at which lives are shorter than a few samples is slowed down.
    """
    life = contact.scenario.model().mean_life_distance
    tick = life / SAMPLES_A_LIFE if speed is None else min(speed / RATE, life / FEWEST_SAMPLES)
    samples = int(SECONDS * RATE)
    text = contact.scenario_text(distance=samples * tick)
    record = simulate(loads(f'{text}\n[output]\ntick = "{tick:.9g} um"\n\n[run]\nengine = "batch"\n', "surface"))
    area = np.asarray(record.trace["real_contact_area"][:samples], dtype=np.float64)
    values = area - area.mean()
    values *= _PEAK / np.abs(values).max()
    content = coded(written(lambda path: write_wave(path, [values], samples=values.size, rate=RATE, texts={})))
    heard = f"at a sliding speed of {tick * RATE * 1e-3:.3g} mm/s"
    return content, f"The real contact area of the scenario as it changes {heard}."
