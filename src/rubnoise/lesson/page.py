"""The page of lessons: one self-contained file, assembled from its parts."""

import json
from collections.abc import Iterator
from html import escape
from importlib.resources import files
from importlib.resources.abc import Traversable
from typing import Any, Final

from rubnoise.lesson.settings import Settings

_FIRST: Final = (
    "numbers.js",
    "random.js",
    "model.js",
    "rows.js",
    "transform.js",
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
    }
    filled = {
        "title": escape(title),
        "subtitle": escape(_subtitle(settings)),
        "replaying": escape(record["note"] if record else ""),
        "style": "\n".join(_texts(".css")),
        "data": json.dumps(data).replace("<", "\\u003c"),  # no title can end the element that holds it
        "script": "\n".join(_texts(".js")),
    }
    return _filled(_part("page.html"), filled)


def _subtitle(settings: Settings) -> str:
    if not settings.borrowed:
        return ""
    return f"The scenario has no {' and no '.join(settings.borrowed)}: that of the paper's Figure 5 stands in."


def script_parts() -> list[str]:
    """Return the names of the script's parts in the order in which they run."""
    names = {part.name for part in _parts().iterdir() if part.name.endswith(".js")}
    return [*_FIRST, *sorted(names - {*_FIRST, _LAST}), _LAST]


def _texts(ending: str) -> Iterator[str]:
    names = script_parts() if ending == ".js" else sorted(part.name for part in _parts().iterdir())
    yield from (_part(name) for name in names if name.endswith(ending))


def _filled(text: str, values: dict[str, str]) -> str:
    """Put each value into its place, none into another value: what stands in a title is text."""
    pieces = text.split("@")
    return "".join(values[piece] if i % 2 else piece for i, piece in enumerate(pieces))


def _part(name: str) -> str:
    return (_parts() / name).read_text(encoding="utf-8")


def _parts() -> Traversable:
    return files("rubnoise.lesson") / "parts"
