from pathlib import Path

import pytest

from tests.cli.terminal import CONTACT, WITH_SLIDER


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
