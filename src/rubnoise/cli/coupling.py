"""Whether one-way coupling can be taken at its word: figures by name, and as lines to print."""

from typing import Any

from rubnoise.cli.layout import WORTH_A_WARNING, line, number, one_way_warning, remark
from rubnoise.theory.exact import Exact


def coupling_figures(theory: Exact) -> dict[str, Any]:
    """Return by name what judges one-way coupling, of a model with a slider; a change not known is None, with why."""
    found = theory.coupling()
    figures: dict[str, Any] = {
        "coupling_strength": found.strength,
        "stick_number": found.stick_number,
        "expected_change": found.expected_change,
    }
    return figures if found.unknown is None else figures | {"expected_change": None, "change_unknown": found.unknown}


def coupling_lines(slider: dict[str, Any], *, two_way: bool) -> list[str]:
    """Return the same as lines to print, one-way validity first, and a warning where two-way coupling is needed."""
    validity = slider["one_way_validity"]
    doubt = [remark(f"warning: {one_way_warning(validity)}")] if validity > WORTH_A_WARNING and not two_way else []
    return [
        line("one-way validity", f"{validity:.6g} (std of velocity over sliding speed)"),
        line("coupling strength", f"{number(slider['coupling_strength'])} (Pi; weak below 0.03)"),
        line("stick number", f"{number(slider['stick_number'])} (theta; a slow slider sticks above 1)"),
        line("expected change", _change(slider)),
        *doubt,
    ]


def _change(slider: dict[str, Any]) -> str:
    change = slider["expected_change"]
    if change is None:
        return f"not known: {slider['change_unknown']}"
    return f"{change - 1.0:+.2%} of std displacement, if two-way"
