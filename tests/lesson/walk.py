"""A page in a browser, watched for anything that goes wrong on it, and walks through its lessons."""

import re
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

# A page in a browser: opened from a file, watched for anything that it asks of others or that goes wrong on it.
CALM = {"reduced_motion": "reduce"}
"""A visitor who wants nothing to move: the page does not begin to play by itself."""
UNHURRIED = "window.requestAnimationFrame = (f) => setTimeout(() => f(performance.now()), 400);"
"""Draw two or three frames per second. Where a test only reads text, sixty take more time than everything else."""

UNFOLD = "document.getElementById('more-controls').open = true"
"""Show the controls that the open lesson does not need."""

LONGEST_WAIT = 30.0  # s


def until(page: Any, condition: str) -> None:
    """Wait for a condition; the page's policy forbids what playwright's own waiting would need."""
    end = time.monotonic() + LONGEST_WAIT
    while not page.evaluate(condition):
        assert time.monotonic() < end, condition
        page.wait_for_timeout(10)


def painted(page: Any) -> None:
    """Wait for two frames of the page. Everything that was to be drawn before is on the screen then."""
    page.evaluate("requestAnimationFrame(() => requestAnimationFrame(() => (document.painted = true)))")
    until(page, "document.painted")
    page.evaluate("delete document.painted")


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


# Walks through the lessons on the page as a student does, by the words that stand on it.
class Walk:
    """One page with one lesson open."""

    def __init__(self, page):
        self.page = page

    @property
    def article(self):
        return self.page.locator("article.lesson")

    def open(self, title):
        self.page.get_by_role("navigation", name="Lessons", exact=True).get_by_role("button", name=title).click()

    def predict(self, index=0):
        self.article.locator("#lesson-predict").get_by_role("radio").nth(index).check()
        self.article.locator("#lesson-predict [type=submit]").click()

    def run(self, index=0):
        self.article.locator("[data-run]").nth(index).click()

    def slide_on(self):
        """Slide 200 lives ahead; of a trace that is read by eye, note a reading instead."""
        if self.article.locator("#reading-form").count():
            self.read(20)
        elif self.article.locator("#reading-said").count() == 0:
            self.article.locator('[data-act="ahead"]').first.click()

    def read(self, length):
        """Lay the bar of a trace, so many um long, and note it."""
        self.article.locator("#reading-length").fill(str(length))
        self.article.locator("#reading-form [type=submit]").click()

    def look(self, index=0):
        """Slide on until the lesson asks what is seen, and say it; a bet asks when all of its runs have gone on."""
        self.slide_on()
        for other in range(1, self.article.locator("[data-run]").count()):
            if self.article.locator("#lesson-observe").count() == 0:
                self.run(other)
                self.slide_on()
        self.say(index)

    def say(self, index=0):
        """Say what is seen."""
        self.article.locator("#lesson-observe").get_by_role("radio").nth(index).check()
        self.article.locator("#lesson-observe [type=submit]").click()

    def to_the_checks(self):
        self.predict()
        self.run()
        self.look()

    @property
    def forms(self):
        return self.article.locator("form.lesson-check")

    def answer(self, question, text):
        """Give an answer to a question by its number, and return whether it was right and what the page said."""
        form = self.forms.nth(question)
        if form.get_by_role("radio").count():
            form.get_by_role("radio", name=text, exact=False).first.check()
        elif form.locator("input").count():
            form.locator("input").fill(text)
        else:
            self.turn(text)
        form.get_by_role("button", name="Check").click()
        return form.get_attribute("data-verdict") == "right", form.get_by_role("status").inner_text()

    def turn(self, text):
        """Turn a knob: 'speed 100 mm/s'."""
        self.page.evaluate(UNFOLD)
        knob, value = re.fullmatch(r"(\w+) (\S+) \S+", text).groups()
        number = self.page.locator(f"#exact-{knob}")
        number.fill(value)
        number.press("Enter")

    @property
    def end(self):
        return self.article.locator("#lesson-end").inner_text()
