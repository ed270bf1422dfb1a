"""The examples on a page of Markdown: Python blocks and shell commands, in the order in which a reader meets them."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from tests.architecture.sources import ROOT

ELSEWHERE = {"reading.md"}
"""Pages whose examples need tools of their own, and are run by the tests in tests/reading."""
BLOCK = re.compile(r"^```(\w*)\n((?:(?!^```$).*\n)*)^```$|^ {4}(\S.*)$", re.MULTILINE)
SHELLS = {"sh", "bash", "console"}


@dataclass(frozen=True, slots=True)
class Example:
    """One Python block or one shell command, and the line of the page on which it begins."""

    kind: Literal["python", "shell"]
    text: str
    line: int


def pages() -> list[str]:
    """Return the pages whose examples are run, relative to the root: the README, then those of its table, in order."""
    table = (ROOT / "README.md").read_text(encoding="utf-8").partition("\n## Where to look\n")[2]
    listed = dict.fromkeys(re.findall(r"\]\((docs/[\w-]+\.md)\)", table))
    return ["README.md", *(page for page in listed if page.removeprefix("docs/") not in ELSEWHERE)]


def examples(page: str) -> Iterator[Example]:
    """Yield every ```python block, and every command after `$ ` or indented by four columns that calls rubnoise."""
    for found in BLOCK.finditer(page):
        line = page.count("\n", 0, found.start()) + 1
        language, block, indented = found.groups()
        if language == "python":
            yield Example("python", block, line + 1)
        elif block is not None and language in SHELLS:
            for offset, text in enumerate(block.splitlines(), start=1):
                yield from _command(text, line + offset)
        elif indented is not None:
            yield from _command(indented, line)


def _command(text: str, line: int) -> Iterator[Example]:
    prompted = text.startswith("$ ")
    command = text.removeprefix("$ ")
    if prompted or command.startswith("rubnoise "):
        yield Example("shell", command, line)
