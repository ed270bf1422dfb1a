"""One browser for the tests of every page; where there is none, they are skipped and say so."""

import shutil
from collections.abc import Iterator
from typing import Any

import pytest

CHROMIUMS = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    """Return a browser of playwright's, one for all tests."""
    found = next((path for name in CHROMIUMS if (path := shutil.which(name))), None)
    if found is None:
        pytest.skip("NO CHROMIUM FOUND: the page of lessons is not tested; install chromium to test it")
    api = pytest.importorskip("playwright.sync_api", reason="NO PLAYWRIGHT FOUND: the page of lessons is not tested")
    with api.sync_playwright() as playwright:
        started = playwright.chromium.launch(executable_path=found, args=["--no-sandbox"])
        yield started
        started.close()
