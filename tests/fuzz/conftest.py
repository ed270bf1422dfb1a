"""The scripts that throw damaged files are no part of the package: their modules are found in tools."""

import sys

from tests.architecture.sources import ROOT

sys.path.append(str(ROOT / "tools"))
