"""Walks through the lessons on the page as a student does, by the words that stand on it."""

import re


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

    def to_the_checks(self):
        self.predict()
        self.run()

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
        knob, value = re.fullmatch(r"(\w+) (\S+) \S+", text).groups()
        number = self.page.locator(f"#exact-{knob}")
        number.fill(value)
        number.press("Enter")

    @property
    def end(self):
        return self.article.locator("#lesson-end").inner_text()
