"""The command line, called in this process."""

import sys
from collections.abc import Sequence
from contextlib import chdir
from pathlib import Path
from unittest.mock import patch

from rubnoise.cli.app import main


def command(words: Sequence[str], folder: Path) -> int:
    """Call a command in a folder and return its exit code."""
    with chdir(folder), patch.object(sys, "argv", ["rubnoise", *words]):
        try:
            main()
        except SystemExit as left:
            return left.code if isinstance(left.code, int) else int(left.code is not None)
    return 0
