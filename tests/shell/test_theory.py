"""`rubnoise theory`: what is exact about a scenario, in words, as JSON, as a table, as a picture."""

import csv
from io import StringIO
from pathlib import Path
from typing import Any

import pytest

import rubnoise
from tests.shell.terminal import PAPER, call, names

CONTACT = Path("../given/contact.toml")
SLIDER = Path("../given/slider.toml")
FIG5 = PAPER / "fig5.toml"


def told(*arguments: str | Path) -> Any:
    answer = call("theory", *arguments, "--json")
    assert (answer.code, answer.err) == (0, "")
    return answer.values()


def test_an_empty_start_is_told_of(here: Path) -> None:
    assert "from_empty" not in told(CONTACT)
    found = told(CONTACT, "--at-distance", "0,-3,2,1e6")["from_empty"]
    assert found["distance"] == [0.0, -3.0, 2.0, 1e6]
    assert found["area_mean"][:2] == found["count_mean"][:2] == [0.0, 0.0]
    assert found["area_mean"][3] == pytest.approx(200.0, rel=1e-10)
    # One size: lam s are alive, and each has the area of the lens so far.
    diameter = (200.0 / 20.0 * 3.0) ** 0.5
    assert found["count_mean"][2] == pytest.approx(20.0 * 2.0 / (2.0 * diameter), rel=1e-12)
    assert found["run_count_mean"] == pytest.approx(20.0 * (1.0 - diameter / 300.0), rel=1e-6)
    assert found["run_area_mean"] == pytest.approx(200.0 * (1.0 - diameter / 300.0), rel=1e-8)
    empty = told(CONTACT, "--set", "sliding.start=empty")["from_empty"]
    assert empty["distance"][0] == 0.0
    assert empty["distance"][-1] == pytest.approx(2.0 * diameter)
    assert empty["run_area_mean"] == found["run_area_mean"]
    assert "run area mean" in call("theory", CONTACT, "--set", "sliding.start=empty").out


def test_what_welchs_method_shows_is_told_of(here: Path) -> None:
    found = told(CONTACT, "--segment", "64")["estimated_spectrum"]
    exact = rubnoise.exact(rubnoise.load(CONTACT)).estimated_spectrum(64)
    assert (found["ticks"], found["segments"]) == (64, exact.segments)
    for name in ("wavenumber", "density", "standard_error"):
        assert found[name] == getattr(exact, name).tolist()
    regular = told(CONTACT, "--segment", "64", "--set", "birth.law=regular")["estimated_spectrum"]
    assert "standard_error" not in regular
    assert len(regular["density"]) == 33
    text = call("theory", CONTACT, "--segment", "64").out
    table = text[text.index("\nestimated spectrum") :].split("\n\n")[0].splitlines()[5:]
    assert len([line for line in table if line.strip()[:1].isdigit()]) == 9  # of 33 bins


def test_changes_and_results_are_taken(here: Path) -> None:
    assert call("run", SLIDER, "-q", "-o", "x.h5").code == 0
    assert told("x.h5") | {"title": ""} == told(SLIDER) | {"title": ""}
    assert told(SLIDER, "--set", "interface.mean_junction_count=40")["count"]["mean"] == pytest.approx(40.0, rel=1e-3)
    refused = call("theory", "x.h5", "--set", "run.seed=3")
    assert (refused.code, refused.out) == (2, "")
    assert "x.h5: is a result" in refused.err


def test_the_table_holds_the_numbers_of_the_json(here: Path) -> None:
    points = (
        "--at-wavenumber",
        "0,1",
        "--at-lag",
        "2",
        "--at-area",
        "200,300",
        "--at-distance",
        "3",
    )
    answer = call("theory", FIG5, "--csv", *points)
    heading, *rows = csv.reader(StringIO(answer.out))
    assert heading == ["part", "name", "at", "value", "unit", "exact", "error", "interval", "z", "note"]
    found = {(part, name, at): (value, unit) for part, name, at, value, unit, *_ in rows}
    json_ = told(FIG5, *points)
    assert found["slider", "expected_change", ""] == ("", "")
    assert found["area", "mean", ""] == (str(json_["area"]["mean"]), "um^2")
    assert found["cumulants", "area", "3"] == (str(json_["cumulants"]["area"][2]), "")
    assert found["spectrum", "density", "1.0"] == (str(json_["spectrum"]["density"][1]), "um^4/(rad/um)")
    assert found["distribution", "cdf", "300.0"] == (str(json_["distribution"]["cdf"][1]), "")
    assert float(found["slider", "upcrossing_rate", ""][0]) == json_["slider"]["upcrossing_rate"]
    assert found["from_empty", "area_mean", "3.0"] == (str(json_["from_empty"]["area_mean"][0]), "um^2")
    assert found["from_empty", "run_count_mean", ""] == (str(json_["from_empty"]["run_count_mean"]), "")
    table = call("theory", FIG5, "--csv", *points, "--segment", "4").out
    assert table.count("\nestimated_spectrum,standard_error,") == 3
    assert "\nestimated_spectrum,segments,,99999," in table


@pytest.mark.slow
@pytest.mark.parametrize("name", ["t.png", "t.pdf", "t.svg"])
def test_it_is_drawn(here: Path, name: str) -> None:
    pytest.importorskip("matplotlib")
    assert call("theory", SLIDER, name, "--plot").out == f"{name}\n"
    assert names(here) == [name]
    refused = call("theory", SLIDER, name, "--plot")
    assert refused.code == 2
    assert f"{name}: exists already" in refused.err
    assert call("theory", CONTACT, "--plot").out == "contact_theory.png\n"


def test_regular_births_have_lines_and_no_distribution(here: Path) -> None:
    triangles = ("--set", "pulse.shape=triangle", "--set", "birth.law=regular")
    odd = told(CONTACT, *triangles, "--set", "interface.mean_junction_count=5", "--at-lag", "0", "--at-wavenumber", "1")
    assert "distribution" not in odd
    lines = odd["spectral_lines"]
    assert len(lines["wavenumber"]) == 64
    assert 2.0 * sum(lines["power"]) == pytest.approx(odd["autocovariance"]["value"][0], rel=1e-6)
    assert odd["area"]["std"] == pytest.approx(odd["area"]["mean"] / (3**0.5 * 25.0), rel=1e-9)
    assert odd["spectrum"]["density"] == [0.0]
    even = told(CONTACT, *triangles, "--set", "interface.mean_junction_count=6")
    assert even["area"]["std"] == 0.0
    assert even["area"]["skewness"] is even["area"]["excess_kurtosis"] is None
    assert "spectral_lines" not in even
    text = call("theory", CONTACT, *triangles, "--set", "interface.mean_junction_count=5").out
    assert "spectral lines" in text
    assert "distribution" not in text
    table = call("theory", CONTACT, *triangles, "--csv").out
    assert "\narea,skewness,,,," in table
