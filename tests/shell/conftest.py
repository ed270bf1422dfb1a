import os
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.shell.terminal import CONTACT, WITH_SLIDER

WITHOUT_RIGHTS = ("setpriv", "--bounding-set=-dac_override,-dac_read_search", "--")


@pytest.fixture
def here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Stand in an empty folder, beside one with two scenarios: `given/contact.toml` and `given/slider.toml`."""
    folder, given = tmp_path / "here", tmp_path / "given"
    folder.mkdir()
    given.mkdir()
    (given / "contact.toml").write_text(CONTACT, encoding="utf-8")
    (given / "slider.toml").write_text(WITH_SLIDER, encoding="utf-8")
    monkeypatch.chdir(folder)
    return folder


@pytest.fixture
def unprivileged() -> tuple[str, ...]:
    """Return what to put before a command so that permissions hold, also for root."""
    if os.geteuid() != 0:
        return ()
    if shutil.which(WITHOUT_RIGHTS[0]) is None or subprocess.run([*WITHOUT_RIGHTS, "true"], check=False).returncode:
        pytest.skip("run as root, and setpriv cannot drop its rights: every folder can be written")
    return WITHOUT_RIGHTS
