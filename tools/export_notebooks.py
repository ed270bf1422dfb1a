"""Make plain notebooks and static pages from the marimo sources: `python tools/export_notebooks.py [--html FOLDER]`.

notebooks/NAME.ipynb has the cells of notebooks/NAME.py for Jupyter, Colab and the like: texts become Markdown cells,
and a control becomes its value. A test finds one that is outdated. With --html every notebook is run, and
FOLDER/NAME.html has its texts, code and results in one file that loads nothing: formulas and pictures are in it.
"""

import argparse
import ast
import base64
import contextlib
import html
import io
import json
import re
import sys
import types
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

from markdown_it import MarkdownIt

from rubnoise.web_page import part, web_page

ROOT: Final = Path(__file__).resolve().parent.parent
NOTEBOOKS: Final = ROOT / "notebooks"
FORMULA: Final = re.compile(r"\$\$(.+?)\$\$|\$(.+?)\$", re.DOTALL)
STYLE: Final = "pre.code { border-left: 3px solid #0072b2; }"
INSTALL: Final = '# Where rubnoise is missing, as in Colab: %pip install "rubnoise[analysis,plot]"\n'


@dataclass(frozen=True)
class Cell:
    """A cell: Markdown or Python."""

    kind: str
    text: str


def cells_of(source: str) -> list[Cell]:
    """Return the cells of a marimo notebook as those of one without marimo."""
    functions = [
        node
        for node in ast.parse(source).body
        if isinstance(node, ast.FunctionDef) and any(ast.unparse(each) == "app.cell" for each in node.decorator_list)
    ]
    found = [_cell(source, function) for function in functions]
    first = next(number for number, cell in enumerate(found) if cell.kind == "code")
    found[first] = Cell("code", INSTALL + found[first].text)
    return found


def _cell(source: str, function: ast.FunctionDef) -> Cell:
    if (text := _markdown(function)) is not None:
        return Cell("markdown", text)
    lines = source.splitlines(keepends=True)[function.body[0].lineno - 1 : function.end_lineno]
    # Comments above the first statement belong to the cell.
    above = source.splitlines(keepends=True)[function.lineno : function.body[0].lineno - 1]
    text = "".join(line.removeprefix("    ") for line in [*above, *lines])
    return Cell("code", _without_marimo(text).strip("\n") + "\n")


def _markdown(function: ast.FunctionDef) -> str | None:
    """Return the text of a cell that only shows one."""
    body = [node for node in function.body if not isinstance(node, ast.Return)]
    if len(body) != 1 or not isinstance(body[0], ast.Expr) or not isinstance(body[0].value, ast.Call):
        return None
    call = body[0].value
    if ast.unparse(call.func) != "mo.md" or not isinstance(call.args[0], ast.Constant):
        return None
    lines = str(call.args[0].value).strip("\n").splitlines()
    return "\n".join(line.removeprefix("    ") for line in lines).strip() + "\n"


def _without_marimo(text: str) -> str:
    """Return code in which a control is its value, a sound one of IPython's, and the return of the cell is gone."""
    changes: list[tuple[ast.AST, str]] = []
    tree = ast.parse(f"def _():\n{_indented(text)}")
    shift = 1  # line numbers begin below the def
    for node in ast.walk(tree):
        if isinstance(node, ast.Return) or (isinstance(node, ast.Import) and node.names[0].name == "marimo"):
            changes.append((node, ""))
        elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Call):
            name = ast.unparse(node.value.func)
            if name == "mo.hstack":
                changes.append((node, ""))
            elif name == "mo.audio":
                sound = ast.unparse(node.value.args[0])
                changes.append((node, f"from IPython.display import Audio\n\nAudio({sound})"))
        elif isinstance(node, ast.Call) and ast.unparse(node.func).startswith("mo.ui."):
            value = next(ast.unparse(each.value) for each in node.keywords if each.arg == "value")
            changes.append((node, f"SimpleNamespace(value={value})"))
    lines = _indented(text).splitlines()
    for node, new in sorted(changes, key=lambda change: -change[0].lineno):  # type: ignore[attr-defined]
        first, last = node.lineno - 1 - shift, node.end_lineno - 1 - shift  # type: ignore[attr-defined]
        head, tail = lines[first][: node.col_offset], lines[last][node.end_col_offset :]  # type: ignore[attr-defined]
        kept = head + new.replace("\n", f"\n{head}") + tail
        lines[first : last + 1] = [kept] if kept.strip() else []
    plain = "\n".join(line[4:] for line in "\n".join(lines).splitlines())
    return f"from types import SimpleNamespace\n\n{plain}" if "SimpleNamespace(" in plain else plain


def _indented(text: str) -> str:
    return "\n".join(f"    {line}" if line.strip() else line for line in text.splitlines())


def _shown_once(cell: Cell) -> list[str]:
    """Return the lines of a cell without a figure as its last one: Jupyter shows a figure of pyplot by itself."""
    lines = cell.text.splitlines(keepends=True)
    return lines[:-1] if lines[-1:] == ["_figure\n"] else lines


def plain_notebook(cells: list[Cell]) -> str:
    """Return a notebook of format 4.5, without outputs."""
    made: list[dict[str, Any]] = [
        {"cell_type": cell.kind, "id": f"cell-{number}", "metadata": {}, "source": _shown_once(cell)}
        | ({"execution_count": None, "outputs": []} if cell.kind == "code" else {})
        for number, cell in enumerate(cells)
    ]
    about = {
        "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
        "language_info": {"name": "python"},
    }
    content = {"cells": made, "metadata": about, "nbformat": 4, "nbformat_minor": 5}
    return json.dumps(content, ensure_ascii=False, indent=1) + "\n"


@contextlib.contextmanager
def _sound() -> Iterator[None]:
    """Offer what notebooks take from IPython, where it is not installed."""
    display: Any = types.ModuleType("IPython.display")
    display.Audio = Sound
    package: Any = types.ModuleType("IPython")
    package.display = display
    package.get_ipython, package.version_info = lambda: None, (99, 0)  # matplotlib asks
    before = {name: sys.modules.get(name) for name in ("IPython", "IPython.display")}
    sys.modules.update({"IPython": package, "IPython.display": display})
    try:
        yield
    finally:
        for name, module in before.items():
            if module is None:
                del sys.modules[name]
            else:
                sys.modules[name] = module


class Sound:
    """A sound that a page plays, as IPython has one."""

    def __init__(self, data: bytes) -> None:
        """Take the bytes of a WAV file."""
        self._data = data

    def _repr_html_(self) -> str:
        return f'<audio controls src="{_inline("audio/wav", self._data)}"></audio>'


def results(cells: list[Cell]) -> Iterator[tuple[str, Any]]:
    """Run the cells in one namespace; yield what each code cell prints, and the value of its last line."""
    import matplotlib as mpl

    mpl.use("Agg")
    names: dict[str, Any] = {"__name__": "__main__"}
    with _sound():
        for cell in cells:
            printed, value = io.StringIO(), None
            if cell.kind == "code":
                tree = ast.parse(cell.text)
                last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
                with contextlib.redirect_stdout(printed):
                    exec(compile(tree, "notebook", "exec"), names)  # noqa: S102  (our own notebooks)
                    if isinstance(last, ast.Expr):
                        value = eval(compile(ast.Expression(last.value), "notebook", "eval"), names)  # noqa: S307
            yield printed.getvalue(), value


def static_page(title: str, cells: list[Cell]) -> str:
    """Return a page with texts, code and results in it; the notebook is run for it."""
    parts = []
    for cell, (printed, value) in zip(cells, results(cells), strict=True):
        if cell.kind == "markdown":
            parts.append(_text(cell.text))
            continue
        parts.append(f"<pre class=code><code>{html.escape(cell.text.strip())}</code></pre>")
        if printed:
            parts.append(f"<pre>{html.escape(printed)}</pre>")
        if value is not None:
            parts.append(f"<div>{_shown(value)}</div>")
    return web_page(f"<main>{''.join(parts)}</main>", title=title, styles=[part("rubnoise.pages", "report.css"), STYLE])


def _shown(value: Any) -> str:
    """Return a value as a page shows it: a picture, its own HTML, or its text."""
    if hasattr(value, "savefig"):
        import matplotlib.pyplot as plt

        picture = io.BytesIO()
        value.savefig(picture, format="png", dpi=120)
        plt.close(value)
        return f'<img alt="the picture that this cell draws" src="{_inline("image/png", picture.getvalue())}">'
    if hasattr(value, "_repr_html_"):
        return str(value._repr_html_())
    return f"<pre>{html.escape(repr(value))}</pre>"


def _text(text: str) -> str:
    """Return Markdown as HTML, its formulas as MathML, which Markdown shall not touch."""
    from docutils.utils.math.latex2mathml import tex2mathml  # type: ignore[import-untyped]

    formulas: list[str] = []

    def kept(found: re.Match[str]) -> str:
        formulas.append(tex2mathml(found[1] or found[2], as_block=found[1] is not None))
        return f"FORMULA{len(formulas) - 1}END"

    page = MarkdownIt("commonmark").enable("table").render(FORMULA.sub(kept, text))
    return re.sub(r"FORMULA(\d+)END", lambda found: formulas[int(found[1])], page)


def _inline(kind: str, data: bytes) -> str:
    return f"data:{kind};base64,{base64.b64encode(data).decode()}"


def main(arguments: list[str]) -> int:
    """Write every plain notebook and, where they are asked for, the pages."""
    parser = argparse.ArgumentParser(prog="export_notebooks.py", description="Make plain notebooks and static pages.")
    parser.add_argument("--html", type=Path, metavar="FOLDER", help="run every notebook, and write a page of each here")
    folder = parser.parse_args(arguments).html
    for path in sorted(NOTEBOOKS.glob("*.py")):
        cells = cells_of(path.read_text(encoding="utf-8"))
        path.with_suffix(".ipynb").write_text(plain_notebook(cells), encoding="utf-8")
        if folder is not None:
            folder.mkdir(parents=True, exist_ok=True)
            title = next(cell.text for cell in cells if cell.kind == "markdown").partition("\n")[0].removeprefix("# ")
            (folder / f"{path.stem}.html").write_text(static_page(title, cells), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
