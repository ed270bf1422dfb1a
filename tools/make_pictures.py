"""Draw the pictures of the documentation: `.venv/bin/python tools/make_pictures.py`, after `tools/dev.py sync`."""

import sys
import tempfile
from pathlib import Path

from small_png import small

import rubnoise
from rubnoise.figures.overview import overview_figure
from rubnoise.figures.stretch import Stretch
from rubnoise.figures.style import as_png, house_style
from rubnoise.storage.reader import open_run

ROOT = Path(__file__).resolve().parent.parent
PICTURES = ROOT / "docs" / "pictures"
JUNCTION = 60


def main() -> int:
    """Run the scenario of Figure 5 and draw it."""
    PICTURES.mkdir(exist_ok=True)
    scenario = rubnoise.load(ROOT / "scenarios" / "paper" / "fig5.toml")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "fig5.h5"
        rubnoise.run(scenario, path).close()
        with open_run(path) as file, house_style():
            (PICTURES / "fig5.png").write_bytes(small(as_png(overview_figure(Stretch.of(file), JUNCTION))))
    return 0


if __name__ == "__main__":
    sys.exit(main())
