"""A self-contained web page: it holds its styles, scripts and data, and its policy forbids every request."""

import json
from base64 import b64encode
from collections.abc import Iterable, Mapping, Sequence
from html import escape
from importlib.resources import files
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

_SCRIPT: Final = """<script type="application/json" id="data">@data@</script>
<script>
@script@
</script>
"""


def web_page(
    body: str, *, title: str, styles: Sequence[str], scripts: Sequence[str] = (), data: Mapping[str, Any] | None = None
) -> str:
    """Return the text of a page from the HTML of its body, its title, and the texts of its styles and scripts.

    The scripts find ``data`` as JSON in the element `data`. Without scripts the page may run none. A title stays text,
    whatever is written in it.
    """
    text = json.dumps(data, allow_nan=False).replace("<", "\\u003c")  # no text can end the element that holds it
    script = filled(_SCRIPT, {"data": text, "script": "\n".join(scripts)}) if scripts else ""
    policy = ("script-src 'unsafe-inline'; " if scripts else "") + "img-src data:; media-src data:"
    values = {"title": escape(title), "style": "\n".join(styles), "body": body, "policy": policy, "script": script}
    return filled(part("rubnoise", "frame.html"), values)


def report_page(title: str, sections: Mapping[str, str], below: str = "") -> str:
    """Return a page of sections by their headings, those that have content; on paper those with sound are left out."""
    shown = (
        f'<section class="{"on-screen" if "<audio" in content else ""}"><h2>{escape(heading)}</h2>{content}</section>'
        for heading, content in sections.items()
        if content
    )
    body = "\n".join(["<main>", f"<h1>{escape(title)}</h1>", f"<p>{escape(below)}</p>", *shown, "</main>"])
    return web_page(body, title=title, styles=[part("rubnoise.figures", "report.css")])


def filled(text: str, values: Mapping[str, str]) -> str:
    """Return a text with each ``@name@`` replaced by its value; a value is not searched for further names."""
    return "".join(values[piece] if i % 2 else piece for i, piece in enumerate(text.split("@")))


def part(package: str, name: str) -> str:
    """Return the text of a file in the folder `parts` of a package."""
    return (files(package) / "parts" / name).read_text(encoding="utf-8")


def script_parts(package: str, names: Iterable[str]) -> dict[str, str]:
    """Return what all pages share and files of a package by name, each as a function of its own."""
    sources = [("rubnoise", "arrays"), ("rubnoise", "areas"), *((package, name) for name in names)]
    return {name: f"(() => {{\n'use strict';\n{part(place, f'{name}.js')}}})();" for place, name in sources}


def packed(values: NDArray[Any]) -> dict[str, str]:
    """Return an array in the form of a page: its type, little-endian, and its bytes in base 64."""
    little = np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("<"))
    return {"type": little.dtype.str.lstrip("<|"), "bytes": coded(little.tobytes())}


def coded(content: bytes) -> str:
    """Return bytes in base 64."""
    return b64encode(content).decode("ascii")
