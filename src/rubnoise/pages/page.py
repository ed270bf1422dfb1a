"""Common parts of the pages of runs and sweeps: styles and scripts around a template."""

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any, Final

from rubnoise.record.rows import Reader
from rubnoise.web_page import filled, part, script_parts, web_page

HERE: Final = "rubnoise.pages"


def page(template: str, *, title: str, styles: Sequence[str], scripts: Sequence[str], data: Mapping[str, Any]) -> str:
    """Return the text of a page: a template, styles and scripts by their names in `parts/`, a title and data."""
    return web_page(
        filled(part(HERE, template), {"title": escape(title)}),
        title=title,
        styles=[part(HERE, name) for name in styles],
        scripts=[part(HERE, "uPlot.iife.min.js"), *script_parts(HERE, scripts).values()],
        data=data,
    )


def side_by_side(pages: Mapping[str, str]) -> str:
    """Return one page with the pages of two runs beside each other, by their names; their windows move together."""
    shown = ((escape(name), escape(text)) for name, text in pages.items())
    frames = (f'<div><p>{name}</p><iframe title="{name}" srcdoc="{text}"></iframe></div>' for name, text in shown)
    return web_page(
        "\n".join(frames),
        title=" and ".join(pages),
        styles=[part(HERE, "beside.css")],
        scripts=[*script_parts(HERE, ["beside"]).values()],
        data={},
    )


def last_time(file: Reader, group: str) -> float:
    """Return the time in s of the last row of a group."""
    rows = file.rows(group)
    return float(file.column(group, "time", rows - 1, rows)[0])
