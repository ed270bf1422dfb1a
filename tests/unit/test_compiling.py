"""Machine code: when it is kept, the coefficients in it, and what a run is expected to cost."""

from __future__ import annotations

import ast
import errno
import importlib.util
import math
import os
import re
import runpy
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import mpmath
import numba
import pytest
from numba.core.caching import IndexDataCacheFile

import rubnoise
from rubnoise import compiling
from rubnoise.contact.laws import Spread
from rubnoise.simulation.cost import PROGRAM_BYTES, working_bytes
from tests.models import bare, model

# Machine code that is kept is not used any more once a file has changed that was compiled into it.
PROGRAM = """
import numpy as np
from rubnoise.simulation.kernels.coarse import deposit_coarse_lives as deposit
total, nothing, one = np.zeros(16), np.empty(0), np.ones(1)
deposit(np.arange(16.0), 1.0, 0, 3, np.zeros(1), one, one, one, nothing, total, nothing, 0)
print(sum(deposit.stats.cache_hits.values()), total[1] + total[2])
"""


def test_a_changed_file_is_compiled_anew_into_others(tmp_path: Path) -> None:
    package = tmp_path / "rubnoise"
    shutil.copytree(Path(rubnoise.__file__).parent, package, ignore=shutil.ignore_patterns("__pycache__"))

    def output() -> list[str]:
        variables = {**os.environ, "PYTHONPATH": str(tmp_path), "NUMBA_CACHE_DIR": str(tmp_path / "kept")}
        command = [sys.executable, "-c", PROGRAM]
        return subprocess.run(command, env=variables, capture_output=True, text=True, check=True).stdout.split()

    assert output() == ["0", "0.0"]
    assert output() == ["1", "0.0"]
    grid = package / "simulation" / "kernels" / "grid.py"
    changed = grid.read_text(encoding="utf-8").replace("positions[index] < distance", "positions[index] <= distance")
    grid.write_text(changed, encoding="utf-8")
    hits, _ = output()
    assert hits == "0"


def test_of_two_processes_one_compiles_and_the_other_loads(tmp_path: Path) -> None:
    """As the workers of the tests do (tests/warm.py); without turns both would compile."""
    program = f"from tests.warm import take_turns\ntake_turns()\n{PROGRAM}"
    variables = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[2]), "NUMBA_CACHE_DIR": str(tmp_path)}
    words = [sys.executable, "-c", program]
    both = [subprocess.Popen(words, env=variables, stdout=subprocess.PIPE, text=True) for _ in range(2)]
    assert sorted(each.communicate()[0].split()[0] for each in both) == ["0", "1"]


def test_every_file_that_is_compiled_into_others_is_known() -> None:
    """A file whose functions or constants others compile into theirs, and that was left out, would stay as it was."""
    package = Path(rubnoise.__file__).parent
    texts = {path.relative_to(package): path.read_text(encoding="utf-8") for path in package.rglob("*.py")}
    compiled = {
        path
        for path, text in texts.items()
        if re.search(r"^from rubnoise\.compiling import|import intrinsic", text, re.MULTILINE)
    }
    known = {path.relative_to(package) for pattern in compiling.SOURCES for path in package.glob(pattern)}
    imported = {
        path.with_name(module.split(".")[-1] + ".py")
        for importer in compiled
        for module in re.findall(r"^from rubnoise\.([\w.]+) import", texts[importer], re.MULTILINE)
        for path in [Path(*module.split("."))]
    }
    assert {path for path in imported & compiled if path not in known} == set()
    assert Path("simulation/kernels/lens.py") in imported & compiled & known


GONE = b"\x80\x04\x8c\x12rubnoise.compiling\x8c\x04Gone\x93."
"""The pickle of a class that an earlier version had."""


DAMAGES: dict[str, Callable[[bytes], bytes]] = {
    "a class that is gone": lambda _: GONE,
    "empty": lambda _: b"",
    "cut off": lambda content: content[:-100],
    "zeros": lambda content: bytes(len(content)),
}

DOUBLING = """
from rubnoise.compiling import compiled


@compiled
def doubled(value):
    return 2.0 * value
"""


@pytest.fixture
def doubling(tmp_path: Path) -> Path:
    """A module with a kernel, whose code is kept beside it."""
    module = tmp_path / "doubling.py"
    module.write_text(DOUBLING, encoding="utf-8")
    return module


def _hits(module: Path) -> int:
    """Call the kernel of a module as a new process would; return how often its code was found."""
    found: dict[str, Any] = runpy.run_path(str(module))
    assert found["doubled"](21.0) == 42.0
    return sum(found["doubled"].stats.cache_hits.values())


@pytest.mark.parametrize("ending", [".nbi", ".nbc"])
@pytest.mark.parametrize("damage", DAMAGES)
def test_kept_code_that_is_not_as_it_was_written_is_compiled_anew(doubling: Path, ending: str, damage: str) -> None:
    assert [_hits(doubling), _hits(doubling)] == [0, 1]
    (kept,) = (doubling.parent / "__pycache__").glob(f"*{ending}")
    kept.write_bytes(DAMAGES[damage](kept.read_bytes()))
    assert [_hits(doubling), _hits(doubling)] == [0, 1]


def test_where_code_cannot_be_kept_it_is_compiled_each_time_and_said_once(
    doubling: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(_file: object, path: str, _what: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device", path)

    monkeypatch.setattr(compiling, "_NOT_KEPT", [])
    monkeypatch.setattr(IndexDataCacheFile, "_save_data", full)
    with pytest.warns(compiling.CodeNotKept, match=r"__pycache__: No space left on device") as warned:
        assert [_hits(doubling), _hits(doubling)] == [0, 0]
    assert len(warned) == 1


def test_what_is_compiled_is_announced(doubling: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    said: list[str] = []
    monkeypatch.setattr(compiling, "BEFORE_COMPILING", {lambda: said.append("compiling")})
    assert [_hits(doubling), said, _hits(doubling), said] == [0, ["compiling"], 1, ["compiling"]]
    monkeypatch.setattr(compiling, "njit", _nowhere)
    assert [_hits(doubling), said] == [0, ["compiling"] * 2]


def _nowhere(*, cache: bool = False, **how: Any) -> Any:
    if cache:
        raise RuntimeError("cannot cache function: no locator available")
    return numba.njit(**how)


# The polynomials of the kernel: made by the tool, equal to those in the kernel's file, good to the last digits.
ROOT = Path(__file__).parents[2]
TOOL = ROOT / "tools" / "kernel_coefficients.py"
KERNELS = ROOT / "src" / "rubnoise" / "simulation" / "kernels" / "lens.py"
FINE = KERNELS.with_name("fine.py")
GRID = [10.0**exponent for exponent in range(-14, 0, 2)] + [i / 97 for i in range(1, 98)]


def load_tool() -> ModuleType:
    spec = importlib.util.spec_from_file_location("kernel_coefficients", TOOL)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


tool = load_tool()


def generated_constants(text: str) -> dict[str, object]:
    """Return the names and values between the two markers of a source text."""
    start, stop = tool.generated_span(text)
    block = ast.parse("\n".join(text.splitlines()[start:stop]))
    return {
        statement.targets[0].id: ast.literal_eval(statement.value)
        for statement in block.body
        if isinstance(statement, ast.Assign) and isinstance(statement.targets[0], ast.Name)
    }


def evaluated(integrations: int, polynomial: object, u: float) -> float:
    """Return the lens area (d = 1) or one of its running integrals in double, as the kernel does."""
    value = float(math.sqrt(u) * tool.horner(polynomial, u))
    for _ in range(integrations + 1):
        value *= u
    return value


@pytest.fixture(scope="module")
def kernel_text() -> str:
    return KERNELS.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def constants(kernel_text: str) -> dict[str, object]:
    return generated_constants(kernel_text)


def test_the_tool_writes_what_stands_in_the_kernels() -> None:
    assert tool.main(["--check", str(KERNELS)]) == 0
    assert tool.main(["--near", "--check", str(FINE)]) == 0
    assert tool.main(["--check", str(FINE)]) == 1


@pytest.mark.parametrize("target", tool.TARGETS, ids=lambda target: target.name)
def test_the_polynomials_near_the_ends_hold_to_the_last_digits(target: object) -> None:
    integrations = target.integrations  # type: ignore[attr-defined]
    constants = generated_constants(FINE.read_text(encoding="utf-8"))
    polynomial = constants[f"NEAR_{target.name}"]  # type: ignore[attr-defined]
    with mpmath.workdps(120):
        for u in (0.25 * u for u in GRID):
            exact = tool.closed_form(integrations, mpmath.mpf(u))
            assert abs(evaluated(integrations, polynomial, u) / exact - 1) <= 1.2e-15, u
        beyond = evaluated(integrations, polynomial, 1.0) / tool.closed_form(integrations, mpmath.mpf(1))
        assert abs(beyond - 1) > 1e-12


def test_one_changed_digit_is_seen_and_written_back(tmp_path: Path, kernel_text: str) -> None:
    first = repr(generated_constants(kernel_text)["AREA_COEFFICIENTS"][0])  # type: ignore[index]
    changed = tmp_path / "kernels.py"
    changed.write_text(kernel_text.replace(first, first[:-1] + str((int(first[-1]) + 1) % 10)), encoding="utf-8")
    assert tool.main(["--check", str(changed)]) == 1
    assert tool.main(["--write", str(changed)]) == 0
    assert changed.read_text(encoding="utf-8") == kernel_text


@pytest.mark.parametrize("text", ["", tool.BEGIN, f"{tool.END}\n{tool.BEGIN}\n", f"{tool.BEGIN}\n{tool.END}\n" * 2])
def test_a_file_without_one_block_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="expected one block"):
        tool.generated_span(text)


@pytest.mark.parametrize("target", tool.TARGETS, ids=lambda target: target.name)
def test_the_kernel_polynomials_hold_to_the_last_digits(target: object, constants: dict[str, object]) -> None:
    integrations = target.integrations  # type: ignore[attr-defined]
    polynomial = constants[target.name]  # type: ignore[attr-defined]
    with mpmath.workdps(120):
        for u in GRID:
            exact = tool.closed_form(integrations, mpmath.mpf(u))
            assert abs(evaluated(integrations, polynomial, u) / exact - 1) <= 1.2e-15, u


@pytest.mark.parametrize(("name", "exact"), [("FIRST", "1/3"), ("SECOND", "pi/32"), ("THIRD", "1/45")])
def test_the_peaks_are_rounded_once(name: str, exact: str, constants: dict[str, object]) -> None:
    values = {"1/3": mpmath.mpf(1) / 3, "pi/32": mpmath.pi / 32, "1/45": mpmath.mpf(1) / 45}
    assert constants[f"{name}_INTEGRAL_PEAK"] == float(values[exact])


@pytest.mark.parametrize("integrations", [1, 2, 3])
def test_each_closed_form_is_the_integral_of_the_one_before(integrations: int) -> None:
    # Quadrature of a function that is u^1.5 times an analytic one: in w = sqrt(u) it is analytic.
    with mpmath.workdps(30):
        for u in (mpmath.mpf("0.1"), mpmath.mpf("0.7"), mpmath.mpf(1)):
            integral = mpmath.quad(lambda w: 2 * w * tool.closed_form(integrations - 1, w * w), [0, mpmath.sqrt(u)])
            assert abs(integral / tool.closed_form(integrations, u) - 1) < mpmath.mpf("1e-18")


@pytest.mark.parametrize("integrations", [0, 1, 2, 3])
def test_the_series_is_the_closed_form(integrations: int) -> None:
    with mpmath.workdps(40):
        for u in (mpmath.mpf("0.25"), mpmath.mpf(1)):
            series = u ** (mpmath.mpf(3) / 2 + integrations) * tool.smooth_factor(integrations, u)
            assert abs(series / tool.closed_form(integrations, u) - 1) < mpmath.mpf("1e-33")


# Estimates of memory and time: how they grow, and that they are near what a process really takes.
ENGINES = ("events", "batch")


@pytest.mark.parametrize("engine", ENGINES)
def test_memory_does_not_depend_on_the_length_of_a_run(engine: Any) -> None:
    assert working_bytes(model(distance=1e5), engine) == working_bytes(model(distance=1e7), engine)


@pytest.mark.parametrize("engine", ENGINES)
def test_memory_grows_with_the_number_of_junctions_at_once(engine: Any) -> None:
    equal = Spread(absolute=0.0)
    needs = [working_bytes(bare(count=count, spread=equal, distance=1e4), engine) for count in (1e4, 1e5, 1e6)]
    assert 3.0 < needs[1] / needs[0] < 10.0
    assert needs[2] / needs[1] == pytest.approx(10.0, rel=0.2)


@pytest.mark.parametrize("engine", ENGINES)
def test_a_thin_contact_needs_no_more_memory_than_another(engine: Any) -> None:
    assert working_bytes(model(count=0.01, distance=1e6), engine) <= 2 * working_bytes(model(distance=1e6), engine)
    assert working_bytes(model(count=0.01, distance=1e6), engine) < 0.25 * PROGRAM_BYTES
