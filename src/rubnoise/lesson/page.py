"""The page of lessons: one self-contained file, assembled from its parts."""

from html import escape
from importlib.resources import files
from typing import Any, Final

from rubnoise.lesson.readings import readings
from rubnoise.lesson.settings import Settings
from rubnoise.web_page import filled, part, web_page

_HERE: Final = "rubnoise.lesson"
_FIRST: Final = (
    "numbers.js",
    "random.js",
    "model.js",
    "rows.js",
    "transform.js",
    "off_centre.js",
    "theory.js",
    "theory_regular.js",
    "theory_density.js",
    "world.js",
    "slider.js",
    "field.js",
    "piece.js",
    "motion.js",
    "trace.js",
    "run.js",
    "seen.js",
    "reading.js",
    "plot.js",
    "stage.js",
    "stack.js",
    "traces.js",
)
_LAST: Final = "main.js"
"""Parts of the script that others build on come first, and the one that begins comes last."""


def page(title: str, settings: Settings, record: dict[str, Any] | None = None) -> str:
    """Return the text of the page for a title, settings, and the junctions of a run if there is one.

    It makes no requests: styles, script and data stand in it, and its policy forbids every request.
    """
    data = {
        "title": title,
        "world": settings.world | {"coupling": settings.coupling},
        "distance": settings.distance,
        "sliderStart": settings.slider_start,
        "record": record,
        "readings": readings(),
    }
    styles, scripts = ([part(_HERE, name) for name in names] for names in (_names(".css"), script_parts()))
    subtitle = escape(_subtitle(settings))
    body = filled(
        part(_HERE, "page.html"),
        {"title": escape(title), "subtitle": subtitle, "replaying": escape(record["note"] if record else "")},
    )
    return web_page(body, title=title, styles=styles, scripts=scripts, data=data)


def _subtitle(settings: Settings) -> str:
    if not settings.borrowed:
        return ""
    return f"The scenario has no {' and no '.join(settings.borrowed)}: that of the paper's Figure 5 stands in."


def script_parts() -> list[str]:
    """Return the names of the script's parts in the order in which they run."""
    return [*_FIRST, *sorted({*_names(".js")} - {*_FIRST, _LAST}), _LAST]


def _names(ending: str) -> list[str]:
    return sorted(each.name for each in (files(_HERE) / "parts").iterdir() if each.name.endswith(ending))
