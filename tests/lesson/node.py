"""The model of the page, run by node without a page around it."""

import json
import shutil
import subprocess
from typing import Any

import pytest

from rubnoise.lesson.page import script_parts
from tests.architecture.sources import PACKAGE

PARTS = PACKAGE / "lesson" / "parts"
WITHOUT_A_PAGE = script_parts()[: script_parts().index("plot.js")]
FIGURE_5: dict[str, Any] = {
    "meanArea": 200.0,
    "meanCount": 20.0,
    "spread": 0.2,
    "births": "poisson",
    "pulse": "lens",
    "offset": "none",
    "calibration": "paper",
    "speed": 1000.0,
    "strength": 250.0,
    "mass": 0.005,
    "stiffness": 300.0,
    "damping": 0.05,
    "seed": 1,
}


def answer(body: str, **given: Any) -> Any:
    """Return what the body of a JavaScript function returns, with values by name, and the page's model as ``rub``.

    Skips the test where there is no node.
    """
    node = shutil.which("node")
    if node is None:
        pytest.skip("NO NODE FOUND: the model of the page of lessons is not tested without a browser")
    model = "\n".join((PARTS / name).read_text(encoding="utf-8") for name in WITHOUT_A_PAGE)
    program = (
        f"{model}\nconst ask = ({', '.join(given)}) => {{ {body} }};\n"
        f"const given = JSON.parse(require('fs').readFileSync(0, 'utf8'));\n"
        "const plain = (key, value) => ArrayBuffer.isView(value) ? Array.from(value) : value;\n"
        "process.stdout.write(JSON.stringify(ask(...given), plain));\n"
    )
    done = subprocess.run(
        [node, "-e", program], input=json.dumps([*given.values()]), capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)
