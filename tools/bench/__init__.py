"""The benchmark: speed and accuracy of rubnoise and other tools for the same work; `tools/dev.py bench`."""

import os

for library in ("OPENBLAS", "MKL", "OMP"):
    # One thread each: idle threads of a linear algebra library burn time without work, and double lsim's time.
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")
