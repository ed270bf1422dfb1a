"""The benchmark is no part of the package: its modules are found in tools."""

import sys

from tests.architecture.sources import ROOT

sys.path.append(str(ROOT / "tools"))
