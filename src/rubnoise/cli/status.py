"""One line on the terminal that says what is being done, and goes away when it is done."""

import sys
from types import TracebackType
from typing import Self

from rubnoise.cli.terminal import cut


class StatusLine:
    """Shows what it is told, each text in place of the one before; nothing at all where ``shown`` is False."""

    def __init__(self, *, shown: bool) -> None:
        """Begin with an empty line."""
        self._shown = shown
        self._width = 0

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, problem: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._width:
            self.tell("")
            sys.stderr.write("\r")
            sys.stderr.flush()

    def tell(self, text: str) -> None:
        """Show a text in place of what is there."""
        if self._shown:
            text = cut(text, sys.stderr)
            sys.stderr.write("\r" + text.ljust(self._width))
            sys.stderr.flush()
            self._width = len(text)
