"""Files of figures: what they are, and that they say nothing about when and by what they were made."""

import hashlib
import subprocess
import sys
import warnings
from io import BytesIO

import pytest

from rubnoise.figures.style import FORMATS, Format, as_bytes, house_style, logarithmic, new_figure

BEGINNINGS = {"png": b"\x89PNG\r\n\x1a\n", "pdf": b"%PDF-", "svg": b"<?xml"}
ANEW = """
import hashlib, sys
from tests.figures.test_style import FORMATS, drawn
print(*(hashlib.sha256(drawn(kind)).hexdigest() for kind in FORMATS))
"""


def drawn(kind: Format) -> bytes:
    with house_style():
        figure = new_figure(3.0, 2.0)
        axes = figure.subplots()
        axes.fill_between([0.0, 1.0], [1.0, 3.0], hatch="//", clip_on=True)
        axes.set_title("costs $5 of µm²")
        return as_bytes(figure, kind)


def test_a_figure_is_the_same_in_another_process() -> None:
    done = subprocess.run([sys.executable, "-c", ANEW], capture_output=True, text=True, check=True)
    assert done.stdout.split() == [hashlib.sha256(drawn(kind)).hexdigest() for kind in FORMATS]


@pytest.mark.parametrize("kind", FORMATS)
def test_a_file_is_of_its_kind_and_names_no_date(kind: Format) -> None:
    picture = drawn(kind)
    assert picture.startswith(BEGINNINGS[kind])
    assert b"CreationDate" not in picture
    assert b"dc:date" not in picture
    assert b"atplotlib v" not in picture


def test_powers_of_ten_are_letters_that_the_font_has() -> None:
    with house_style():
        figure = new_figure(3.0, 2.0)
        axes = figure.subplots()
        axes.plot([1e-3, 1e12], [1.0, 1e5])
        for axis in (axes.xaxis, axes.yaxis):
            logarithmic(axis)
        axes.set_xlim(1e-3, 1e12)
        labels = [text.get_text() for text in axes.get_xticklabels()]
        assert {"10⁻³", "10⁰", "10¹²"} <= set(labels)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            figure.savefig(BytesIO(), format="svg")


def test_an_axis_without_a_power_of_ten_has_numbers_all_the_same() -> None:
    with house_style():
        figure = new_figure(3.0, 2.0)
        axes = figure.subplots()
        axes.plot([2.0, 8.0], [2.0, 800.0])
        for axis in (axes.xaxis, axes.yaxis):
            logarithmic(axis)
        figure.draw_without_rendering()
        narrow, wide = ([text.get_text() for text in axis.get_minorticklabels()] for axis in (axes.xaxis, axes.yaxis))
    assert "4" in narrow
    assert set(wide) <= {""}
