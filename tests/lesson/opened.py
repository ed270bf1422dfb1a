"""A page in a browser: opened from a file, watched for anything that it asks of others or that goes wrong on it."""

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

CALM = {"reduced_motion": "reduce"}
"""A visitor who wants nothing to move: the page does not begin to play by itself."""
UNHURRIED = "window.requestAnimationFrame = (f) => setTimeout(() => f(performance.now()), 100);"
"""Draw ten frames per second. Where a test only reads text, sixty take more time than everything else."""

LONGEST_WAIT = 30.0  # s


def until(page: Any, condition: str) -> None:
    """Wait for a condition; the page's policy forbids what playwright's own waiting would need."""
    end = time.monotonic() + LONGEST_WAIT
    while not page.evaluate(condition):
        assert time.monotonic() < end, condition
        page.wait_for_timeout(10)


@contextmanager
def opened(browser: Any, address: str, *, init: str = "", **context: Any) -> Iterator[Any]:
    """Open a page in a context of its own (1400 by 900 pixels unless said otherwise); check that all went well."""
    where = browser.new_context(**({"viewport": {"width": 1400, "height": 900}} | context))
    page = where.new_page()
    requests: list[str] = []
    trouble: list[str] = []
    page.on("request", lambda request: requests.append(request.url))
    page.on("pageerror", lambda error: trouble.append(str(error)))
    page.on("console", lambda message: trouble.append(message.text))
    if init:
        page.add_init_script(init)
    page.goto(address)
    yield page
    assert trouble == []
    assert {url.split("#")[0] for url in requests} == {address.split("#", maxsplit=1)[0]}
    where.close()
