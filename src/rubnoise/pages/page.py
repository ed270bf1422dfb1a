"""One self-contained web page, put together from the parts in `parts/`."""

import json
from base64 import b64encode
from collections.abc import Mapping, Sequence
from html import escape
from importlib.resources import files
from typing import Any

import numpy as np
from numpy.typing import NDArray


def page(template: str, *, title: str, styles: Sequence[str], scripts: Sequence[str], data: Mapping[str, Any]) -> str:
    """Return the text of a page: a template of `parts/`, its title, and styles, scripts and data inside it.

    The page makes no request; its policy forbids them all. A title stays text, whatever is written in it.
    """
    values = {
        "title": escape(title),
        "style": "\n".join(map(part, styles)),
        "data": json.dumps(data, allow_nan=False).replace("<", "\\u003c"),  # no text can end the element that holds it
        "script": "\n".join(map(part, scripts)),
    }
    return filled(part(template), values)


def filled(text: str, values: Mapping[str, str]) -> str:
    """Return a text with each ``@name@`` replaced by its value; a value is not searched for further names."""
    pieces = text.split("@")
    return "".join(values[piece] if i % 2 else piece for i, piece in enumerate(pieces))


def part(name: str) -> str:
    """Return the text of a file in `parts/`."""
    return (files("rubnoise.pages") / "parts" / name).read_text(encoding="utf-8")


def packed(values: NDArray[Any]) -> dict[str, str]:
    """Return an array as a page holds it: its type, little-endian, and its bytes in base 64."""
    little = np.ascontiguousarray(values, dtype=values.dtype.newbyteorder("<"))
    return {"type": little.dtype.str.lstrip("<|"), "bytes": b64encode(little.tobytes()).decode("ascii")}
