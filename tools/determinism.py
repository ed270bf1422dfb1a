"""The same bits everywhere: `python3 tools/determinism.py [--here] [--python PYTHON]...`, once dev.py has set up.

The golden runs and draws of tests/golden are computed again under other settings of the processor, of Python and of
threads, and with the oldest and the newest libraries that pyproject.toml allows, in environments that are made in a
temporary folder; `--here` leaves those out. Prints a table in Markdown with the largest difference of a golden value,
over the largest of its column, and with what differs; exit code 1 where anything does.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
import time
import tomllib
from dataclasses import dataclass, field
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Any

sys.path.insert(0, str(Path(__file__).resolve().parent))

from mutants import PYTHON, ROOT, copy_into

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

GLIBC_PLAIN = "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F"
FEATURES = """
from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__
print(*(name for name in __cpu_dispatch__ if __cpu_features__[name]))
"""
PROBE = """
import json, math, zlib
import numpy as np
from tests.golden import hashes
x = np.linspace(0.1, 9.0, 100_000)
libraries = [np.exp(x), np.array([math.exp(value) ** 1.7 for value in x.tolist()])]
exponentials = zlib.crc32(np.concatenate(libraries).tobytes())
print(json.dumps({"numpy": np.__version__, "exp": exponentials, "runs": hashes.hashes(), "draws": hashes.draws()}))
"""
"""Beside the hashes, the exponentials and powers of numpy and of the C library: what a setting is able to change."""
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")


@dataclass(frozen=True)
class Place:
    """A Python with libraries, by its name and interpreter, and the copy of the source that is run there."""

    name: str
    python: Path
    source: Path = ROOT


@dataclass(frozen=True)
class Setting:
    """Something that might change bits: variables of the environment."""

    name: str
    variables: Mapping[str, str] = field(default_factory=dict)


def settings(features: Sequence[str]) -> Iterator[Setting]:
    """Yield what a run must not depend on, for a numpy that has chosen these instruction sets."""
    wide = [name for name in features if "AVX512" in name or name == "X86_V4"]
    generic = {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""}
    plain = {"NPY_DISABLE_CPU_FEATURES": " ".join(features)}
    yield Setting("as it is")
    if wide:
        yield Setting("numpy without AVX-512", {"NPY_DISABLE_CPU_FEATURES": " ".join(wide)})
    if features:
        yield Setting("numpy without SIMD", plain)
    yield Setting("glibc without AVX2 and FMA", {"GLIBC_TUNABLES": GLIBC_PLAIN})
    yield Setting("kernels for any processor", generic)
    yield Setting("all of these", {"GLIBC_TUNABLES": GLIBC_PLAIN} | generic | (plain if features else {}))
    for seed in ("0", "1", "4242"):
        yield Setting(f"PYTHONHASHSEED={seed}", {"PYTHONHASHSEED": seed})
    for threads in ("1", "2"):
        yield Setting(f"threads: {threads}", dict.fromkeys(THREADS, threads))


def outcome(place: Place, setting: Setting, cache: Path) -> dict[str, Any]:
    """Return the hashes of all golden runs and draws in a place under a setting; raises CalledProcessError."""
    folder = cache / re.sub(r"\W+", "-", f"{place.name} {setting.variables.get('NUMBA_CPU_NAME', 'native')}")
    environment = os.environ | {
        "PYTHONPATH": os.pathsep.join([str(place.source / "src"), str(place.source)]),
        "PYTHONDONTWRITEBYTECODE": "1",
        "NUMBA_CACHE_DIR": str(folder),
    }
    found: dict[str, Any] = json.loads(_answer(place, PROBE, {**environment, **setting.variables}))
    return found


def features_of(place: Place) -> list[str]:
    """Return the instruction sets that numpy has chosen in a place beyond those it was built for."""
    return _answer(place, FEATURES, os.environ).split()


def _answer(place: Place, code: str, environment: Mapping[str, str]) -> str:
    done = subprocess.run(
        [place.python, "-c", code], cwd=place.source, env=environment, capture_output=True, text=True, check=False
    )
    if done.returncode:
        raise SystemExit(f"{place.name}: exit code {done.returncode}\n{done.stderr}")
    return done.stdout


def golden(source: Path = ROOT) -> dict[str, dict[str, Any]]:
    """Return the hashes and values that the stream version of a source stands for."""
    streams = (source / "src" / "rubnoise" / "streams.py").read_text(encoding="utf-8")
    version = re.findall(r"^STREAM_VERSION = (\d+)$", streams, re.MULTILINE)[0]
    files = {"runs": f"stream_{version}.json", "draws": f"draws_{version}.json"}
    folder = source / "tests" / "golden"
    return {part: json.loads((folder / name).read_text(encoding="utf-8")) for part, name in files.items()}


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


def requirements(oldest: bool) -> list[str]:  # noqa: FBT001  (one of two)
    """Return what the package depends on, by name alone or at the oldest version that it allows."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    parts = [requirement.partition(">=") for requirement in project["dependencies"]]
    return [f"{name}=={version}" if oldest else name for name, _, version in parts]


def environments(pythons: Sequence[Path], source: Path, folder: Path) -> Iterator[Place]:
    """Make an environment of the oldest and one of the newest libraries for each Python, and yield them."""
    for number, python in enumerate(pythons):
        for oldest in (True, False):
            name = f"{python.name}, {'oldest' if oldest else 'newest'}"
            made = Place(name, folder / f"{number}-{oldest}" / "bin" / "python", source)
            _run(python, "-m", "venv", "--without-pip", str(made.python.parent.parent))
            install = ("-m", "pip", "--python", str(made.python), "install", "--quiet", "--only-binary=:all:")
            _run(sys.executable, *install, "--disable-pip-version-check", *requirements(oldest))
            yield made


def _run(*command: str | Path) -> None:
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise SystemExit(f"{' '.join(map(str, command))}\n{done.stdout}{done.stderr}")


def compared(place: Place, cache: Path) -> bool:
    """Print a row for each setting in a place, and return whether all had the golden bits."""
    expected, usual, well = golden(place.source), None, True
    for setting in settings(features_of(place)):
        begun = time.monotonic()
        found = outcome(place, setting, cache)
        usual = found["exp"] if usual is None else usual
        made = {part: found[part] for part in expected}
        other, largest = differing(made, expected), max(differences(made, expected).values())
        exponential = "the same" if found["exp"] == usual else "others"
        verdict = f"{len(other)} differ: {other[0]}" if other else "as golden"
        cells = (place.name, found["numpy"], setting.name, exponential, f"{largest:.1e}", verdict)
        print("|", " | ".join(cells), f"| {time.monotonic() - begun:.0f} s |", flush=True)
        well &= not other
    return well


def main() -> int:
    """Compare all places under all settings; return 1 where a bit differs."""
    parser = argparse.ArgumentParser(description="The golden runs under everything that must not change them.")
    parser.add_argument("--here", action="store_true", help="only in the environment that dev.py has made")
    parser.add_argument("--python", action="append", default=[], help="make environments for this Python as well")
    asked = parser.parse_args()
    print("| libraries | numpy | setting | library exp | largest difference | golden runs | time |")
    print("|---|---|---|---|---|---|---|", flush=True)
    with tempfile.TemporaryDirectory(prefix="rubnoise-determinism-") as place:
        folder, cache = Path(place), Path(place) / "machine code"
        # What is compared with one set of hashes must be one source, also if the source is edited meanwhile.
        (folder / "source").mkdir()
        source = copy_into(folder / "source")
        well = compared(Place("as set up", PYTHON, source), cache)
        for made in () if asked.here else environments([PYTHON, *map(Path, asked.python)], source, folder):
            well &= compared(made, cache)
    return 0 if well else 1


if __name__ == "__main__":
    sys.exit(main())
