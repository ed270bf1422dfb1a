"""Make plain notebooks from the marimo sources: `python3 tools/dev.py generate notebooks`.

notebooks/NAME.ipynb has the cells of notebooks/NAME.py for Jupyter, Colab and the like: texts become Markdown cells,
and a control becomes its value. A test finds one that is outdated.
"""

import json
import re
import sys
from pathlib import Path
from textwrap import dedent
from typing import Any, Final

NOTEBOOKS: Final = Path(__file__).resolve().parent.parent / "notebooks"
INSTALL: Final = '# Where rubnoise is missing, as in Colab: %pip install "rubnoise[analysis,plot]"\n'
CELL_HEAD: Final = re.compile(r"^@app\.cell.*\n(?:async )?def _\([^)]*\):\n", re.MULTILINE)
TEXT: Final = re.compile(r'mo\.md\(r"""\n(.*)"""\)\n', re.DOTALL)
PLAIN: Final = (
    (re.compile(r"^return\b.*\Z", re.MULTILINE | re.DOTALL), ""),
    (re.compile(r"^import marimo as mo\n", re.MULTILINE), ""),
    (re.compile(r"^mo\.hstack\(.*\)\n", re.MULTILINE), ""),
    (re.compile(r"\bmo\.ui\.\w+\(.*\bvalue=([^,)]+).*\)"), r"SimpleNamespace(value=\1)"),
    (re.compile(r"^mo\.audio\(", re.MULTILINE), "Audio("),
    (re.compile(r"^_figure\n\Z", re.MULTILINE), ""),  # Jupyter shows a figure of pyplot by itself
)
"""What stands in code of marimo, and what stands instead in a notebook without it."""

IMPORTED: Final = {"SimpleNamespace": "from types import SimpleNamespace", "Audio": "from IPython.display import Audio"}


def plain_notebook(source: str) -> str:
    """Return a notebook of format 4.5, without outputs, with the cells of one of marimo's."""
    bodies = CELL_HEAD.split(source.partition('\nif __name__ == "__main__":')[0])[1:]
    cells = [_cell(dedent(body)) for body in bodies]
    first = next(lines for kind, lines in cells if kind == "code")
    first.insert(0, INSTALL)
    made: list[dict[str, Any]] = [
        {"cell_type": kind, "id": f"cell-{number}", "metadata": {}, "source": lines}
        | ({"execution_count": None, "outputs": []} if kind == "code" else {})
        for number, (kind, lines) in enumerate(cells)
    ]
    about = {
        "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
        "language_info": {"name": "python"},
    }
    content = {"cells": made, "metadata": about, "nbformat": 4, "nbformat_minor": 5}
    return json.dumps(content, ensure_ascii=False, indent=1) + "\n"


def _cell(code: str) -> tuple[str, list[str]]:
    """Return the kind and the lines of a cell."""
    if text := TEXT.match(code):
        return "markdown", f"{dedent(text[1]).strip()}\n".splitlines(keepends=True)
    for pattern, instead in PLAIN:
        code = pattern.sub(instead, code)
    imports = [line for name, line in IMPORTED.items() if re.search(rf"\b{name}\(", code)]
    return "code", ("\n".join([*imports, *[""] * bool(imports), code.strip("\n")]) + "\n").splitlines(keepends=True)


def main() -> int:
    """Write every plain notebook."""
    for path in sorted(NOTEBOOKS.glob("*.py")):
        path.with_suffix(".ipynb").write_text(plain_notebook(path.read_text(encoding="utf-8")), encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
