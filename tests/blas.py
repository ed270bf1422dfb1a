"""One thread of linear algebra for every test: of matrices as small as ours, further threads only burn time waiting.

The library reads this when numpy is loaded, so `conftest` imports this file first. Processes of tests inherit it.
"""

import os

for library in ("OMP", "OPENBLAS", "MKL"):
    os.environ.setdefault(f"{library}_NUM_THREADS", "1")
