"""Wrong words in Python and in scenarios: each expression of refusals.txt is refused in the words that it has there.

`.venv/bin/python -m pytest -n 0 --freeze tests/unit/test_refusals.py` writes those words anew.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pint
import pytest

import rubnoise
from rubnoise.analysis.where import Condition  # noqa: F401  (as the next ones, for the expressions)
from rubnoise.errors import in_shell
from rubnoise.scenario import build, loads
from rubnoise.storage.schema import TRACE, Dataset  # noqa: F401
from rubnoise.units import LENGTH, QuantityError, read_quantity  # noqa: F401
from tests.frozen import Said
from tests.unit.scenarios import BARE, GRID, HEAD, WHOLE, sweep_of, whole, without  # noqa: F401

SAID = Said(Path(__file__).with_name("refusals.txt"))
BASE = rubnoise.example("paper/fig5").replace(distance="400 um")
CONTACT = {"mean_real_contact_area": 200, "mean_junction_count": 20}
OFF_CENTRE = {"interface": CONTACT, "pulse": {"offset": "uniform"}, "sliding": {"distance": 1000.0}}
LOADED = BARE.replace('mean_real_contact_area = "200 um^2"', 'load = "0.2 N"\nhardness = "1 GPa"')
WEIGHED = LOADED.replace('distance = "20 mm"', 'speed = "1 mm/s"\ndistance = "20 mm"') + (
    '[load]\nheight_scale = "0.5 um"\nmass = "5 g"\ndamping_ratio = 0.05\n'
)
TWO_WAY = '[strength]\nmean = "250 MPa"\n[slider]\nmass = "5 g"\nstiffness = "300 N/m"\ndamping = "0.05 N*s/m"\n'
TWO_WAY += 'coupling = "two-way"\n'
DRIVEN = WHOLE.replace('law = "normal"\nspread = "0.2 um"\n', "").replace(
    "damping =", 'excitation = "base"\nasperity_height = "2 %"\ndamping ='
)
POWER = "exponent = 2.5\nsmallest = 0.5\nlargest = 4.0\n"
OF_FIFTEEN = (
    'format = 1\n[interface]\nmean_junction_count = 15\n[diameter]\nmean = "5 um"\n[sliding]\ndistance = "2 mm"\n'
)
OF_A_FILE = BARE + '[diameter]\nlaw = "empirical"\n'
POINTS = GRID.replace("[sweep]\nreplicates = 2\n", "")
FORCE = 50.0 + np.sin(np.arange(400.0))
TIMES = np.array([0.0, 0.1, 0.2])
UNIT = pint.UnitRegistry()
IN_A_SWEEP = (
    Dataset(name="run_id", units="", long_name="", symbol="", dtype="<U16"),
    Dataset(name="state", units="", long_name="", symbol="", dtype="<U8"),
    Dataset(name="sliding.speed", units="um/s", long_name="", symbol=""),
)


# What expressions call.
def read(text: str, *words: str) -> None:
    """Read a scenario of which no run is possible."""
    loads(text, "run.toml", words).check_size()


def strong(law: str, spread: str = "") -> str:
    """Return the whole scenario with a law of strengths."""
    return WHOLE.replace('mean = "250 MPa"\n', f'mean = "250 MPa"\nlaw = "{law}"\n{spread}')


def powered(own: str = POWER) -> str:
    """Return the whole scenario with a power law of sizes."""
    return whole(law='"power"').replace('spread = "0.2 um"\n', own)


def inferred(**changed: object) -> rubnoise.Inference:
    """Infer from a force that would do."""
    given = {"rate": "10 kHz", "speed": "1 mm/s", "unit": "uN", "zero": "known", "law": "fixed"}
    return rubnoise.infer(FORCE, **given | changed)  # type: ignore[arg-type]


def values(distance: object) -> rubnoise.Scenario:
    """Build a scenario of this distance."""
    return build({"interface": CONTACT, "sliding": {"distance": distance}})


def swept(table: str, *overrides: str, head: str = HEAD) -> object:
    """Read a sweep from a file."""
    return sweep_of(Path(), table, *overrides, head=head)


def slid(**asked: Any) -> str:
    """Slide two surfaces over each other."""
    track, slider = (
        rubnoise.Surface.synthesise(points=512, rolloff="64 um", cutoff="8 um", seed=seed) for seed in (1, 2)
    )
    return track.slide(slider, **{"cutoff": "8 um", "load": "2 N", "hardness": "1 GPa"} | asked).scenario_text()


def of_sizes(text: str) -> rubnoise.Scenario:
    """Load a scenario whose diameters are in a file of this text."""
    Path("sizes.csv").write_text(text, encoding="utf-8")
    return rubnoise.load("contact.toml")


def trace_of(text: str) -> rubnoise.Trace:
    """Read a trace from a file of this text."""
    Path("m.csv").write_text(text, encoding="utf-8")
    return rubnoise.Trace.from_csv("m.csv")


@pytest.fixture(scope="module")
def desk(tmp_path_factory: pytest.TempPathFactory) -> Iterator[dict[str, Any]]:
    """Return what expressions may name, in a folder of a run, a scenario and sizes."""
    record = rubnoise.simulate(BASE)
    trace = rubnoise.Trace({"time (s)": TIMES, "a": [1, 2, 3], "b": [1, 2, 3]})
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(tmp_path_factory.mktemp("desk"))
        record.save("run.h5").close()
        Path("contact.toml").write_text(OF_A_FILE + 'file = "sizes.csv"\ncolumn = "diameter"\n', encoding="utf-8")
        with h5py.File("sizes.h5", "w") as file:
            file["junctions/diameter"], file["strain"] = np.array([4.0, 5.5]), np.eye(2)
        yield globals() | {"record": record, "trace": trace}


@pytest.mark.parametrize("expression", SAID.kept)
def test_a_wrong_expression_is_refused_in_these_words(desk: dict[str, Any], expression: str) -> None:
    with pytest.raises(Exception) as refused:  # noqa: PT011  (of which kind is asserted)
        eval(expression, dict(desk))  # noqa: S307  (a line of our own file)
    assert isinstance(refused.value, rubnoise.RubnoiseError | QuantityError | KeyError | IndexError)
    said = str(refused.value)
    if expression.startswith("inferred("):  # a command says the same of its option
        keyword = expression.partition("(")[2].partition("=")[0]
        assert said.startswith(f"{keyword}=: ")
        assert in_shell(said).startswith(f"--{keyword}: ")
        assert "=" not in in_shell(said)
    SAID.assert_said(expression, "\n".join(filter(None, (said, getattr(refused.value, "hint", "")))))
