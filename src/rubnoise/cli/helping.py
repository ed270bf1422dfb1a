"""What `--help` shows: texts as they are written, in lines that end where the terminal does."""

import re
from inspect import cleandoc
from typing import Any

from typer.core import TyperCommand

_TAG = re.compile(r"(\\*)(\[[a-z#/@][^\[]*?\])")
"""What the library that draws help takes for a style or a colour, and leaves out: `[sweep]`."""


def literal(text: str) -> str:
    """Return a text in which that library finds no styles, each paragraph in one line for it to break."""
    paragraphs = (" ".join(paragraph.split()) for paragraph in cleandoc(text).split("\n\n"))
    return "\n\n".join(_TAG.sub(r"\1\1\\\2", paragraph) for paragraph in paragraphs)


def texts(styled: bool, help_text: str | None, params: Any) -> str | None:
    """Make the help of parameters literal where the library looks for styles; return that of their command."""
    if not styled:
        return help_text
    for param in params or ():
        if getattr(param, "help", None):
            param.help = literal(param.help)
    return literal(help_text) if help_text else help_text


def without_types(params: Any) -> Any:
    """Return parameters of which only options with a value say what they take.

    To a flag nothing is given, and an argument has its name and its help.
    """
    for param in params:
        if getattr(param, "is_flag", False):
            param.metavar = ""
        if param.param_type_name == "argument":
            param.display_type_rich = _no_type
    return params


def _no_type(**_context: Any) -> None:
    return None


class Command(TyperCommand):
    """A command whose help is shown as it is written."""

    def __init__(self, name: str | None, *, help: str | None = None, **rest: Any) -> None:  # noqa: A002  (click's name)
        """Make a command (see click)."""
        styled = rest.get("rich_markup_mode") == "rich"
        super().__init__(name, help=texts(styled, help, rest.get("params")), **rest)

    def get_params(self, ctx: Any) -> Any:
        """Return arguments and options (see click)."""
        return without_types(super().get_params(ctx))
