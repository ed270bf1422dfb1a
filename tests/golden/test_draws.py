"""A uniform stands for the same diameter and the same strength on every processor."""

import json
import os
import subprocess
import sys
import zlib
from pathlib import Path

import numpy as np
import pytest
from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__

from tests.golden.draws import GOLDEN, hashes

EXPECTED = json.loads(GOLDEN.read_text(encoding="utf-8"))
OPTIONAL = [name for name in __cpu_dispatch__ if __cpu_features__[name]]
ROOT = Path(__file__).parents[2]
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


def test_every_law_has_its_golden_bits() -> None:
    assert hashes() == EXPECTED
    assert len(set(EXPECTED.values())) == len(EXPECTED) - 1  # one size alone is the same among the living


def test_no_bit_depends_on_the_instructions_of_the_processor() -> None:
    assert json.loads(in_plain_arithmetic("-m", "tests.golden.draws")) == EXPECTED


@pytest.mark.skipif("X86_V3" not in OPTIONAL, reason="this processor has nothing that changes a library's exp")
def test_a_librarys_exponential_depends_on_them() -> None:
    here = zlib.crc32(np.exp(np.linspace(0.1, 9.0, 100_000)).tobytes())
    assert int(in_plain_arithmetic("-c", LIBRARY)) != here
