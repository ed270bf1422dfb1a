"""The benchmark: rubnoise beside everything else a user could pick, correctness first; `tools/dev.py bench`."""

import os

for library in ("OPENBLAS", "MKL", "OMP"):
    # One thread each: what idle threads of a linear algebra library burn is nobody's work, and doubles lsim's time.
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")
