"""Make plain notebooks from the marimo sources: `python3 tools/dev.py generate notebooks`.

notebooks/NAME.ipynb has the cells of notebooks/NAME.py for Jupyter, Colab and the like: texts become Markdown cells,
and a control becomes its value. A test finds one that is outdated.
"""

import ast
import json
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

ROOT: Final = Path(__file__).resolve().parent.parent
NOTEBOOKS: Final = ROOT / "notebooks"
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


def main() -> int:
    """Write every plain notebook."""
    for path in sorted(NOTEBOOKS.glob("*.py")):
        cells = cells_of(path.read_text(encoding="utf-8"))
        path.with_suffix(".ipynb").write_text(plain_notebook(cells), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
