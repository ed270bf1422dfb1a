from pathlib import Path

import pytest

from tests.setup.sandbox import Sandbox


@pytest.fixture
def sandbox(tmp_path: Path) -> Sandbox:
    made = Sandbox(folder=tmp_path / "rub noise")
    made.fill()
    return made
