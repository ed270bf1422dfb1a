"""The pages of the folder `docs` as one web page, for users who installed the package."""

import base64
import re
from collections.abc import Sequence
from html import escape
from pathlib import Path, PurePosixPath
from typing import Final

from markdown_it import MarkdownIt
from markdown_it.token import Token

from rubnoise.errors import Refused
from rubnoise.web_page import part, web_page

PACKAGE: Final = Path(__file__).parents[1]
HOMES: Final = (PACKAGE / "docs", PACKAGE.parents[1] / "docs")
"""Where an installed package keeps them, and where a checkout does."""

FIRST: Final = ("start", "model", "scenarios", "reading", "your-data", "command-line", "api")
"""The pages that come first, in this order; the others follow by name."""

ELSEWHERE: Final = ("gallery",)
"""Pages that are nothing without pictures, which `rubnoise plot` draws."""

BLOCK: Final = re.compile(r"^\$\$\s*(.+?)\s*\$\$$", re.MULTILINE | re.DOTALL)
FORMULA: Final = re.compile(r"(?<![\\$`\w])\$([^$`\n]+)\$(?![\w$])")


def manual() -> str:
    """Return the text of the web page; raises Refused if the installation does not have the pages."""
    folder = next((home for home in HOMES if (home / f"{FIRST[0]}.md").is_file()), None)
    if folder is None:
        raise Refused(f"docs: not found beside rubnoise in {PACKAGE}; is the installation complete?")
    found = sorted(path.stem for path in folder.glob("*.md"))
    names = [*FIRST, *(name for name in found if name not in (*FIRST, *ELSEWHERE))]
    markdown = MarkdownIt("commonmark").enable("table")
    pages = [_Page(name, markdown.parse(_with_formulas(folder / f"{name}.md"))) for name in names]
    listed = "".join(f'<li><a href="#{page.name}">{escape(page.title)}</a></li>' for page in pages)
    parts = [f'<section id="{page.name}">{page.html(markdown, folder, names)}</section>' for page in pages]
    body = f"<main><nav><ul>{listed}</ul></nav>{''.join(parts)}</main>"
    return web_page(body, title="rubnoise", styles=[part("rubnoise.pages", "report.css")])


def _with_formulas(path: Path) -> str:
    """Return the text of a page with its formulas as code, in TeX."""
    lines, fenced = [], False
    for line in BLOCK.sub(r"```\n\1\n```", path.read_text(encoding="utf-8")).splitlines():
        if line.lstrip().startswith("```"):
            fenced = not fenced
        lines.append(line if fenced or line.startswith("    ") else FORMULA.sub(r"`\1`", line))
    return "\n".join(lines) + "\n"


class _Page:
    """One page as tokens of Markdown, whose headings have names for links from all pages."""

    def __init__(self, name: str, tokens: list[Token]) -> None:
        self.name, self.tokens = name, tokens
        headings = [each for each, token in enumerate(tokens) if token.type == "heading_open"]
        self.title = tokens[headings[0] + 1].content
        for each in headings[1:]:
            linked = re.sub(r"[^\w\- ]", "", tokens[each + 1].content.lower()).replace(" ", "-")
            tokens[each].attrSet("id", f"{name}-{linked}")

    def html(self, markdown: MarkdownIt, folder: Path, names: Sequence[str]) -> str:
        """Return the page as HTML; links to other pages lead to their places, links to files become their texts."""
        for token in self.tokens:
            for child in token.children or ():
                if child.type == "link_open":
                    self._point(child, names)
                elif child.type == "image":
                    _embed(child, folder)
        return str(markdown.renderer.render(self.tokens, markdown.options, {}))

    def _point(self, link: Token, names: Sequence[str]) -> None:
        target = str(link.attrGet("href"))
        if target.startswith(("https://", "http://")):
            return
        file, _, anchor = target.partition("#")
        page = PurePosixPath(file).stem if file else self.name
        if page not in names or not (file == f"{page}.md" or not file):
            link.attrs.clear()
            return
        link.attrSet("href", f"#{page}-{anchor}" if anchor else f"#{page}")


def _embed(image: Token, folder: Path) -> None:
    """Put a drawing into the page; any other picture is replaced by its words."""
    path = folder / str(image.attrGet("src"))
    if path.suffix == ".svg" and path.is_file():
        coded = base64.b64encode(path.read_bytes()).decode()
        image.attrSet("src", f"data:image/svg+xml;base64,{coded}")
        return
    image.type, image.tag, image.children = "text", "", None
    image.content = f"[{image.content}]"
