"""The data and the scripts of a page, without a browser."""

import json
import re
import shutil
import subprocess
from typing import Any

import pytest

from rubnoise.web_page import script_parts
from tests.architecture.sources import PACKAGE

PARTS = PACKAGE / "pages" / "parts"


def data_of(text: str) -> dict[str, Any]:
    """Return the data that a page holds."""
    found = re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.DOTALL)
    assert found is not None
    data: dict[str, Any] = json.loads(found[1])
    return data


def answer(data: dict[str, Any], body: str, **given: Any) -> Any:
    """Return what the body of a JavaScript function returns, with the page's rows, conditions and lives as ``view``.

    Skips the test where there is no node.
    """
    node = shutil.which("node")
    if node is None:
        pytest.skip("NO NODE FOUND: conditions and lives of the page are not tested without a browser")
    parts = "\n".join(script_parts("rubnoise.pages", ("rows", "where", "life", "welch")).values())
    program = (
        "const both = JSON.parse(require('fs').readFileSync(0, 'utf8'));\n"
        "globalThis.document = { getElementById: () => ({ textContent: JSON.stringify(both.data) }) };\n"
        f"{parts}\n"
        f"const ask = ({', '.join(given)}) => {{ {body} }};\n"
        "process.stdout.write(JSON.stringify(ask(...both.given)));\n"
    )
    done = subprocess.run(
        [node, "-e", program],
        input=json.dumps({"data": data, "given": [*given.values()]}),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)
