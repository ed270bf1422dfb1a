"""A seed stands for the same rows on every processor, under every setting: golden values, and exact operations."""

import ast
import json
import os
import subprocess
import sys
import tomllib
import zlib
from collections.abc import Iterator
from pathlib import Path

import determinism
import numpy as np
import pytest
from determinism import differing
from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__

from rubnoise.contact.laws import LAWS
from rubnoise.streams import STREAM_VERSION
from tests.architecture.sources import PACKAGE, ROOT
from tests.golden.hashes import GOLDEN, GOLDEN_DRAWS, RUNS, SEED, SIZES, columns_of, draws
from tests.models import contents, recorded

# A seed stands for the same bits on every processor and with every version of the libraries.
EXPECTED = json.loads(GOLDEN.read_text(encoding="utf-8"))
BRIEF = "matched, relative spread, few"


# What is new gets its bits by python -m tests.golden.hashes --write; those of before change with the stream version.
@pytest.mark.parametrize("name", RUNS)
def test_every_column_has_its_golden_values(name: str) -> None:
    assert differing({name: columns_of(RUNS[name])}, {name: EXPECTED[name]}) == []


def test_every_law_without_lists_has_golden_draws() -> None:
    assert {type(law).__name__.lower() for law in SIZES} == {name for name, entry in LAWS.items() if not entry.own_keys}


@pytest.mark.parametrize("name", [name for name, run in RUNS.items() if run.is_two_way])
def test_a_slider_that_pushes_back_has_them_by_both_engines(name: str) -> None:
    assert differing({name: columns_of(RUNS[name], "batch")}, {name: EXPECTED[name]}) == []
    assert {"slider/phase", "landmarks/kind", "landmarks/time", "junctions/birth_time"} <= EXPECTED[name].keys()
    kinds = recorded(RUNS[name], SEED, engine="batch")["landmarks"]["kind"]
    assert set(kinds.tolist()) == ({0, 1, 2} if "reversals" in name else {0, 1})


def test_the_runs_are_long_enough_to_pass_blocks_and_draw_from_every_stream() -> None:
    assert STREAM_VERSION == 1
    assert recorded(RUNS["figure 5"], SEED).extent.junctions > 9_500
    assert recorded(RUNS["wide sizes, slow, from empty"], SEED).extent.junctions > 300
    assert all(
        recorded(run, SEED).extent.junctions > 1_000 for name, run in RUNS.items() if "tri" in name or "reg" in name
    )


def test_one_bit_changes_a_hash() -> None:
    record = recorded(RUNS["figure 5"], SEED)
    before = contents(record)
    record["trace"]["real_contact_area"].view("u8")[77] ^= 1
    changed = [column for column, data in contents(record).items() if data != before[column]]
    assert changed == [("trace", "real_contact_area")]


@pytest.mark.slow
def test_kernels_for_a_plain_processor_give_the_same_values(tmp_path: Path) -> None:
    """Compiled without vectors of eight and without an instruction that multiplies and adds at once."""
    plain = {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": "", "NUMBA_CACHE_DIR": str(tmp_path)}
    command = [sys.executable, "-m", "tests.golden.hashes", BRIEF]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT, env=os.environ | plain)
    assert differing(json.loads(done.stdout), {BRIEF: EXPECTED[BRIEF]}) == []


# What must not change a bit: hash seeds, threads and what else tools/determinism.py tries, here for one brief run.
HERE = determinism.Place("here", Path(sys.executable))
HARMLESS = {
    setting.name: setting
    for setting in determinism.settings(determinism.features_of(HERE))
    if setting.name.startswith(("PYTHONHASHSEED", "threads", "numpy"))
}


TOGETHER = ("PYTHONHASHSEED=4242", "threads: 2", "numpy without SIMD")
"""One setting of each kind, in one process every day; --all tries each setting alone."""


@pytest.mark.slow
@pytest.mark.parametrize(
    "names",
    [
        [name for name in TOGETHER if name in HARMLESS],
        *([name] for name in HARMLESS),
    ],
    ids=", ".join,
)
def test_a_brief_run_has_its_golden_bits(names: list[str]) -> None:
    assert names
    command = [sys.executable, "-m", "tests.golden.hashes", BRIEF]
    environment = dict(os.environ)
    for name in names:
        environment |= HARMLESS[name].variables
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT, env=environment)
    assert differing(json.loads(done.stdout), {BRIEF: EXPECTED[BRIEF]}) == []


# A uniform stands for the same diameter and the same strength on every processor.
OPTIONAL = [name for name in __cpu_dispatch__ if __cpu_features__[name]]
EXPECTED_DRAWS = json.loads(GOLDEN_DRAWS.read_text(encoding="utf-8"))
PLAIN = {
    "NPY_DISABLE_CPU_FEATURES": " ".join(OPTIONAL),
    "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F",
}
LIBRARY = "import numpy as np, zlib; print(zlib.crc32(np.exp(np.linspace(0.1, 9.0, 100_000)).tobytes()))"


def in_plain_arithmetic(*command: str) -> str:
    """Return what Python prints with every instruction set that a library may choose by itself switched off."""
    environment = os.environ | PLAIN
    done = subprocess.run(
        [sys.executable, *command], capture_output=True, text=True, check=True, cwd=ROOT, env=environment
    )
    return done.stdout


@pytest.mark.slow
def test_every_law_has_its_golden_bits() -> None:
    assert draws() == EXPECTED_DRAWS
    assert len(set(EXPECTED_DRAWS.values())) == len(EXPECTED_DRAWS) - 1  # one size alone is the same among the living


@pytest.mark.slow
def test_no_bit_depends_on_the_instructions_of_the_processor() -> None:
    assert json.loads(in_plain_arithmetic("-m", "tests.golden.hashes", "draws")) == EXPECTED_DRAWS


@pytest.mark.skipif("X86_V3" not in OPTIONAL, reason="this processor has nothing that changes a library's exp")
def test_a_librarys_exponential_depends_on_them() -> None:
    here = zlib.crc32(np.exp(np.linspace(0.1, 9.0, 100_000)).tobytes())
    assert int(in_plain_arithmetic("-c", LIBRARY)) != here


# Whatever is stored is computed by operations that round the same everywhere; those that do not are named here.
# A library's exponential, power or sum may give another last bit on another processor or in another version; Python's
# own sum of floats did so with 3.12. The source of everything between a seed and a stored column is searched for them.
UNSTORED = {"cost.py", "yardstick.py"}
"""The forecast of a run is printed, and not stored."""

FILES = sorted(path for folder in ("contact", "record", "simulation") for path in (PACKAGE / folder).rglob("*.py"))
SEARCHED = [PACKAGE / "streams.py", PACKAGE / "model.py", *(path for path in FILES if path.name not in UNSTORED)]
ELEMENTWISE = """
arccos arccosh arcsin arcsinh arctan arctan2 arctanh cbrt cos cosh exp exp2 expm1 float_power hypot i0 log log10 log1p
log2 logaddexp power sin sinc sinh tan tanh geomspace interp logspace
"""
SUMMING = """
add.reduce add.reduceat average convolve corrcoef cov cumprod dot einsum fft inner linalg matmul mean multiply.reduce
nanmean nanstd nansum nanvar outer polyfit prod std sum tensordot trapezoid var vdot vecdot
"""
NUMPY = {*ELEMENTWISE.split(), *SUMMING.split()}
EXACT_MATH = {"ceil", "comb", "copysign", "factorial", "floor", "frexp", "fsum", "gcd", "inf", "isclose", "isfinite"}
EXACT_MATH |= {"isinf", "isnan", "isqrt", "ldexp", "nan", "nextafter", "pi", "sqrt", "trunc", "ulp"}
METHODS = {"cumprod", "dot", "mean", "prod", "std", "sum", "var"}
BUILTINS = {"pow", "sum"}
REORDERING = "compiled_for_speed"
"""How loops are compiled whose sums the compiler may reorder."""

WHY = tomllib.loads(Path(__file__).with_name("allowed.toml").read_text(encoding="utf-8"))
ALLOWED = {place: why for why, places in WHY.items() for place in places}
"""Where such an operation stands, and why no stored bit comes from it."""


def inexact(text: str, file: str = "") -> set[str]:
    """Return every operation in a source text that need not round the same everywhere, with file and function."""
    return {" ".join(filter(None, (file, *found))) for found in _search(ast.parse(text), "", precise=False)}


def _search(node: ast.AST, where: str, *, precise: bool) -> Iterator[tuple[str, str]]:
    if isinstance(node, ast.FunctionDef | ast.ClassDef):
        where = f"{where}.{node.name}".strip(".")
        # Its powers are those of numbers of 40 digits and more, rounded once.
        precise = precise or any(isinstance(each, ast.Import) and each.names[0].name == "mpmath" for each in node.body)
    for name in _operations(node, precise=precise):
        yield where, name
    for child in ast.iter_child_nodes(node):
        yield from _search(child, where, precise=precise)


def _operations(node: ast.AST, *, precise: bool) -> Iterator[str]:
    match node:
        case ast.BinOp(op=ast.Pow(), left=left, right=right) | ast.AugAssign(op=ast.Pow(), target=left, value=right):
            yield from () if precise or _is_power_of_two(left, right) else ("**",)
        case ast.BinOp(op=ast.MatMult()):
            yield "@"
        case ast.ImportFrom(module=str(module), names=names):
            for alias in names:
                yield from _of_a_library(module, alias.name)
        case ast.Import(names=names):
            yield from (alias.name for alias in names if alias.name.partition(".")[0] == "scipy")
        case ast.Call(func=ast.Name(id=name)) if name in BUILTINS:
            yield name
        case ast.keyword(arg="fastmath"):
            yield "fastmath"
        case ast.Call(func=ast.Attribute(value=owner, attr=attr)) if attr in METHODS and ast.unparse(owner) != "np":
            yield f".{attr}"
        case ast.Attribute(value=owner, attr=attr):
            yield from _of_an_owner(ast.unparse(owner), attr)


def _of_an_owner(owner: str, attr: str) -> Iterator[str]:
    if owner in {"math", "cmath"}:
        yield from _of_a_library(owner, attr)
    elif owner == "np" or owner.startswith("np."):
        yield from (f"np.{name}" for name in {f"{owner}.{attr}".removeprefix("np.")} & NUMPY)


def _of_a_library(module: str, name: str) -> Iterator[str]:
    inexact_here = module == "cmath" or (module == "math" and name not in EXACT_MATH)
    if inexact_here or module.partition(".")[0] == "scipy" or name == REORDERING:
        yield f"{module}.{name}"


def _is_power_of_two(base: ast.expr, exponent: ast.expr) -> bool:
    whole = exponent.operand if isinstance(exponent, ast.UnaryOp) else exponent
    return isinstance(base, ast.Constant) and base.value == 2 and isinstance(whole, ast.Constant)


def relative(path: Path) -> str:
    return path.relative_to(PACKAGE).as_posix()


@pytest.mark.parametrize("path", SEARCHED, ids=relative)
def test_what_is_stored_comes_from_exact_operations(path: Path) -> None:
    assert inexact(path.read_text(encoding="utf-8"), relative(path)) <= ALLOWED.keys()


def test_every_exception_is_one() -> None:
    found = set().union(*(inexact(path.read_text(encoding="utf-8"), relative(path)) for path in SEARCHED))
    assert ALLOWED.keys() <= found
    assert len(SEARCHED) > 30


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("def f(x):\n    return np.exp(x)", {"f np.exp"}),
        ("class C:\n    def f(self):\n        return self.x ** 3", {"C.f **"}),
        ("x **= 2", {"**"}),
        ("a @ b", {"@"}),
        ("np.add.reduce(a), a.sum(), sum(a)", {"np.add.reduce", ".sum", "sum"}),
        ("from math import sqrt, exp", {"math.exp"}),
        ("def f():\n    import scipy.special", {"f scipy.special"}),
        ("from scipy.special import ndtri", {"scipy.special.ndtri"}),
        ("math.sin(x) + cmath.sqrt(x)", {"math.sin", "cmath.sqrt"}),
        ("np.linalg.norm(x)", {"np.linalg"}),
        ("from rubnoise.compiling import compiled, compiled_for_speed", {"rubnoise.compiling.compiled_for_speed"}),
        ("njit(fastmath=True)(f)", {"fastmath"}),
        ("2.0**-53 + np.sqrt(x) + np.add.accumulate(x) + np.cumsum(n)", set()),
        ("def f(x):\n    import mpmath\n    return float(mpmath.mpf(x) ** 2)", set()),
    ],
)
def test_an_inexact_operation_is_found(text: str, found: set[str]) -> None:
    assert inexact(text) == found
