"""The polynomials of the kernel: made by the tool, equal to those in the kernel's file, good to the last digits."""

from __future__ import annotations

import ast
import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import mpmath
import pytest

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
            assert abs(tool.evaluated(integrations, polynomial, u) / exact - 1) <= 1.2e-15, u
        beyond = tool.evaluated(integrations, polynomial, 1.0) / tool.closed_form(integrations, mpmath.mpf(1))
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
            assert abs(tool.evaluated(integrations, polynomial, u) / exact - 1) <= 1.2e-15, u


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
