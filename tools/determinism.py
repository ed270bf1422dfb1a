"""The same bits under every setting: `python3 tools/dev.py check bits`.

The golden runs and draws of tests/reference are computed again under other settings of the processor, of Python and of
threads; what CI does with the oldest and the newest libraries is to run their tests. Prints a table in Markdown with
the largest difference of a golden value, over the largest of its column, and with what differs; exit code 1 where
anything does.
"""

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from math import inf
from pathlib import Path
from typing import Any, Final

import numpy as np

ROOT: Final = Path(__file__).resolve().parents[1]
SIMD: Final[list[str]] = np.show_config(mode="dicts")["SIMD Extensions"].get("found", [])
"""The instruction sets that numpy has chosen here beyond those it was built for."""

THREADS: Final = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
GLIBC: Final = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F"}
GENERIC: Final = {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""}
PLAIN: Final = {"NPY_DISABLE_CPU_FEATURES": " ".join(SIMD)} if SIMD else {}
SETTINGS: Final[dict[str, dict[str, str]]] = {
    "as it is": {},
    "numpy without SIMD": PLAIN,
    "glibc without AVX2 and FMA": GLIBC,
    "kernels for any processor": GENERIC,
    "all of these": GLIBC | GENERIC | PLAIN,
    **{f"PYTHONHASHSEED={seed}": {"PYTHONHASHSEED": seed} for seed in ("0", "1", "4242")},
    **{f"threads: {threads}": dict.fromkeys(THREADS, threads) for threads in ("1", "2")},
}
"""What a run must not depend on: variables of the environment, by name."""


def made(*words: str, **variables: str) -> dict[str, Any]:
    """Return the golden values or draws that a new process computes under a setting; raises CalledProcessError."""
    command = [sys.executable, "-m", "tests.reference.hashes", *words]
    done = subprocess.run(command, cwd=ROOT, env=os.environ | variables, stdout=subprocess.PIPE, check=True)
    found: dict[str, Any] = json.loads(done.stdout)
    return found


def kept(name: str) -> dict[str, Any]:
    """Return the golden values or draws that are kept."""
    found: dict[str, Any] = json.loads((ROOT / "tests" / "golden" / f"{name}_1.json").read_text(encoding="utf-8"))
    return found


def differing(found: Mapping[str, Any], expected: Mapping[str, Any]) -> list[str]:
    """Return the names of the hashes and values that are not what they should be, or are on one side alone.

    A slider that pushes back magnifies what rounds differently, at every stick, to 2e-5 within a second.
    """
    found_by_name = differences(found, expected)
    return [name for name, off in found_by_name.items() if not off <= (2e-5 if "two-way" in name else 1e-10)]


def differences(found: Mapping[str, Any], expected: Mapping[str, Any]) -> dict[str, float]:
    """Return by name how far values are off, over the largest of the column; inf for others, and for other hashes.

    A velocity is all rounding where the force is constant, so the largest counts as 10 um or um/s at least.
    """
    one, other = dict(_flat(found, "")), dict(_flat(expected, ""))
    return {name: _off(one.get(name), other.get(name)) for name in sorted(one.keys() | other.keys())}


def _off(one: Any, other: Any) -> float:
    """Return the largest difference of values that follow the number of rows and the largest, over the largest."""
    if one == other or not (isinstance(one, list) and isinstance(other, list)) or len(one) != len(other):
        return 0.0 if one == other else inf
    pairs = [(a, b) for a, b in zip(one, other, strict=True) if a == a or b == b]  # noqa: PLR0124  (not a number)
    return max(abs(a - b) if a == a and b == b else inf for a, b in pairs) / max(other[1], 10.0)  # noqa: PLR0124


def _flat(tree: Mapping[str, Any], name: str) -> Iterator[tuple[str, Any]]:
    for key, value in tree.items():
        place = f"{name}, {key}".removeprefix(", ")
        yield from _flat(value, place) if isinstance(value, dict) else [(place, value)]


def main() -> int:
    """Print a row for each setting; return 1 where a bit differs."""
    expected = {"runs": kept("stream"), "draws": kept("draws")}
    print("| setting | largest difference | golden runs |\n|---|---|---|", flush=True)
    well = True
    with tempfile.TemporaryDirectory(prefix="rubnoise-determinism-") as folder:
        for name, variables in SETTINGS.items():
            cache = {"NUMBA_CACHE_DIR": str(Path(folder) / variables.get("NUMBA_CPU_NAME", "native"))}
            found = {"runs": made(**cache, **variables), "draws": made("draws", **cache, **variables)}
            other, largest = differing(found, expected), max(differences(found, expected).values())
            print(
                f"| {name} | {largest:.1e} | {f'{len(other)} differ: {other[0]}' if other else 'as golden'} |",
                flush=True,
            )
            well &= not other
    return 0 if well else 1


if __name__ == "__main__":
    sys.exit(main())
