"""A lesson with the keyboard alone, from the first control of the page to the last answer."""

import pytest

MOST_STOPS = 80


def go_to(page, selector):
    """Press Tab until an element has the focus."""
    for _ in range(MOST_STOPS):
        if page.evaluate("selector => document.activeElement.matches(selector)", selector):
            return
        page.keyboard.press("Tab")
    pytest.fail(f"Tab does not lead to {selector}")


def press(page, *keys):
    for key in keys:
        page.keyboard.press(key)


def focused(page):
    return page.evaluate("document.activeElement.id || document.activeElement.textContent")


def test_a_lesson_from_the_list_to_the_last_answer(walk):
    page = walk.page
    go_to(page, '[data-open="1"]')
    press(page, "Enter")
    assert focused(page) == "lesson-title"
    go_to(page, 'input[name="prediction"]')
    press(page, "Space", "ArrowDown", "Enter")
    assert focused(page) == "▶ Births at random"
    press(page, "Enter")
    assert page.evaluate("rub.run.playing")
    assert focused(page) == "▶ Births at random"
    go_to(page, '[data-act="ahead"]')
    press(page, "Enter")
    assert "200 lives" in page.locator("#lesson-running").inner_text()
    go_to(page, 'input[name="observation"]')
    press(page, "Space", "ArrowDown", "Enter")
    assert focused(page) == "Show the law"
    press(page, "Enter")
    assert page.locator("#lesson-law-text").is_visible()
    go_to(page, "#check-longer")
    page.keyboard.type("1/e")
    press(page, "Enter")
    go_to(page, "#check-swing")
    page.keyboard.type("10")
    press(page, "Enter")
    assert walk.end == "Lesson done."
    go_to(page, '.lesson [data-open="2"]')
    press(page, "Space")
    assert page.locator("#lesson-title").inner_text() == "3. The live count"


def test_a_choice_is_made_with_the_arrows(walk):
    page = walk.page
    walk.open("5. The sum")
    walk.to_the_checks()
    go_to(page, 'input[name="check-bell"]')
    press(page, "Space", "Enter")
    assert "all diameters are equal" in page.locator("#check-bell-verdict").inner_text()
    press(page, "ArrowDown", "Enter")
    assert page.locator("#check-bell-verdict").inner_text() == "Right."


def test_typing_an_answer_moves_nothing_else(walk):
    """Letters that are keys of the stage are letters in an answer."""
    page = walk.page
    walk.open("1. One life")
    walk.to_the_checks()
    before = page.evaluate("[rub.run.playing, rub.run.pace, rub.run.selected]")
    go_to(page, "#check-fraction")
    page.keyboard.type("ken0+-p")
    assert page.evaluate("[rub.run.playing, rub.run.pace, rub.run.selected]") == before
    assert page.locator("#check-fraction").input_value() == "ken0+-p"
