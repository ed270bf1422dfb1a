"""Claims of the paper and of its field have verdicts, which follow from numbers, by runs and theory that agree."""

import json
import math
import tomllib
from dataclasses import replace
from math import inf, log, nan
from pathlib import Path
from typing import Any

import numpy as np
import paper.__main__ as program
import pytest
import scipy.special
from paper.ledger import LEDGERS, Claim, Claimed, Ledger, Number, Source, as_row, exponent, unexpected

import rubnoise
from paper import pages
from rubnoise.analysis.replicates import PooledEstimate
from rubnoise.scenario.layers import shipped
from rubnoise.theory.moments import area_cumulants
from rubnoise.theory.second_order import spectral_density
from tests.architecture.sources import ROOT

DOCS = ROOT / "docs"
VERDICTS = {
    "life_mean": "holds with a correction",
    "rabinowicz": "holds with a correction",
    "present_mean": "holds with a correction",
    "mean_area": "holds with a correction",
    "live_count": "holds",
    "constant_speed": "does not hold",
    "area_spread": "holds",
    "psd_decay": "holds",
    "psd_same": "does not hold",
    "psd_sizes": "does not hold",
    "psd_floor": "does not hold",
    "few_or_many": "holds",
}
EXACT = {
    ("life_mean", 0): 1.0 / 3.0,
    ("rabinowicz", 1): 0.0013092,
    ("rabinowicz", 2): 0.000996,
    ("mean_area", 0): 204.6736,
    ("present_mean", 0): 1.0,
    ("live_count", 0): 20.0,
    ("constant_speed", 0): 47.2411,
    ("area_spread", 0): 21.60,
    ("area_spread", 1): 109.25,
    ("identity_one_way", 0): 1.0,
    ("xu2025_measured", 0): 4.016,
    ("rabinowicz1956_diameter", 0): math.sqrt(30.0),
    ("rabinowicz1955_load", 0): -0.5,
    ("rabinowicz1955_finish", 0): 1.0,
    ("campbell_rice", 0): 1.51239,
}
"""Of physics worked out elsewhere, to the digits given."""
QUICK = ("rabinowicz", "area_spread")
"""Scenarios whose runs take a few seconds."""


def _settled(name: str, scenarios: tuple[str, ...] | None = None) -> list[Claim]:
    told: list[str] = []
    found = list(Ledger(LEDGERS[name], told.append).claims(scenarios))
    assert told
    return found


@pytest.fixture(scope="module")
def every() -> dict[str, list[Claim]]:
    """Return the claims of both ledgers, with all their runs."""
    return {name: _settled(name) for name in LEDGERS}


@pytest.fixture(scope="module")
def claims(every: dict[str, list[Claim]]) -> dict[str, Claim]:
    return {claim.id: claim for own in every.values() for claim in own}


@pytest.fixture
def evaluated(every: dict[str, list[Claim]], monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the program have what was evaluated once."""
    monkeypatch.setattr(Ledger, "claims", lambda ledger: iter(every[ledger.path.stem]))


# What the runs say.
def test_claims_of_quick_runs_are_on_the_page_as_they_are_found() -> None:
    written = (DOCS / "paper.md").read_text(encoding="utf-8")
    found = _settled("paper", QUICK)
    assert [claim.id for claim in found] == ["rabinowicz", "area_spread"]
    assert unexpected(found) == []
    section = "\n".join(pages.paper_parts(Ledger(LEDGERS["paper"]), found)["claims"].splitlines())
    for part in section.split("### ")[1:]:
        assert f"### {part.rstrip()}" in written


@pytest.mark.slow
def test_every_claim_is_settled_as_before(every: dict[str, list[Claim]], claims: dict[str, Claim]) -> None:
    assert {claim.id: claim.verdict for claim in every["paper"]} == VERDICTS
    assert unexpected(list(claims.values())) == []
    assert len(claims) == len(VERDICTS) + 33


@pytest.mark.slow
def test_the_exact_numbers_are_those_known(claims: dict[str, Claim]) -> None:
    for (name, index), value in EXACT.items():
        assert claims[name].numbers[index].found.exact == pytest.approx(value, rel=2.5e-4), name
    assert claims["rabinowicz"].numbers[0].found.exact < 1e-12


@pytest.mark.slow
def test_a_wrong_theory_is_noticed(claims: dict[str, Claim]) -> None:
    for claim in claims.values():
        for at, number in enumerate(claim.numbers):
            if not math.isnan(exact := number.found.exact):
                wrong = replace(number.found, exact=1.4 * exact + math.copysign(0.3, exact))
                numbers = (*claim.numbers[:at], replace(number, found=wrong), *claim.numbers[at + 1 :])
                assert replace(claim, numbers=numbers).verdict == "unsettled", claim.id


def _normal_moment(n: int, spread: float) -> float:
    """E[d^n] over d_m^n of a normal diameter, for a spread in um about the 5.53 um of Figure 5."""
    relative = (spread / 5.5300126) ** 2
    pairs = range(0, n + 1, 2)
    return sum(math.comb(n, k) * math.prod(range(1, k, 2)) * relative ** (k // 2) for k in pairs)


@pytest.mark.slow
def test_the_larger_junctions_are_met_more_often_as_moments_say(claims: dict[str, Claim]) -> None:
    for number, spread in zip(claims["present_mean"].numbers, (0.0, 0.2, 1.0, 2.0), strict=True):
        first, second, third = (_normal_moment(n, spread) for n in (1, 2, 3))
        # Redrawing diameters that are not positive moves the moments at 2 um by some 3e-3.
        assert number.found.exact == pytest.approx(third / (first * second), rel=5e-3 if spread == 2.0 else 1e-6)
    assert "0.26 % more with the spread of the paper" in claims["present_mean"].because


@pytest.mark.slow
def test_unequal_sizes_raise_the_spectrum_as_their_sixth_moment_does(claims: dict[str, Claim]) -> None:
    claim = claims["psd_sizes"]
    for number, spread in zip(claim.numbers, (0.2, 1.0, 2.0), strict=False):
        # At low wavenumbers and not at 0, so a little less.
        assert 0.97 < number.found.exact / _normal_moment(6, spread) <= 1.0
    assert "one of 1 µm multiplies $S(0)$ by 1.54, and one of 2 µm by 3.78" in claim.because
    assert _normal_moment(6, 1.0) == pytest.approx(1.54, abs=0.005)
    assert _normal_moment(6, 2.0) == pytest.approx(3.77, abs=0.005)


# What reasons say that no run shows.
def test_scaled_spectra_agree_as_far_as_is_said() -> None:
    models = [
        rubnoise.load(shipped("paper/fig8.toml"), [f"interface.mean_junction_count={count}"]).model()
        for count in (10, 50)
    ]
    phase = np.linspace(0.0, 10.0, 1001)
    few, many = (
        spectral_density(model, phase / model.mean_life_distance)
        / (area_cumulants(model).variance * model.mean_life_distance)
        for model in models
    )
    assert f"within {100.0 * np.abs(few / many - 1.0).max():.1f} % up to" in _reason("paper", "psd_same").replace(
        "%%", "%"
    )


def _reason(ledger: str, name: str) -> str:
    rows = tomllib.loads(LEDGERS[ledger].read_text(encoding="utf-8"))["claim"]
    return " ".join(next(row["because"] for row in rows if row["id"] == name).split())


@pytest.mark.slow
def test_passes_off_the_centres_are_as_the_page_says() -> None:
    """Discs that overlap with centres r diameters apart; x along the line of motion, b across it, even from 0 to 1."""
    area = np.vectorize(lambda r: 0.5 * (math.acos(r) - r * math.sqrt(1.0 - r * r)) if r < 1.0 else 0.0)
    r = (np.arange(20_000) + 0.5) / 20_000
    first, second = (math.pi * float(np.mean(r * area(r) ** n)) for n in (1, 2))
    life = 2.0 * float(np.mean(np.sqrt(1.0 - r * r)))
    page = (DOCS / "paper.md").read_text(encoding="utf-8")
    spread = math.sqrt(second * life) / first  # of the area over its mean, times the root of the number
    for size in (100, 500):
        fall = size * spread * (10.0**-0.5 - 50.0**-0.5)
        assert f"by {fall:.0f} µm² at {size} µm²" in page
    # E_b |A^(k; b)|^2 from the transform of the disc's autocorrelation, means over a period of the swing.
    k = 2.0 * math.pi * np.array([20.0, 80.0])[:, None] + np.linspace(0.0, 2.0 * math.pi, 64, endpoint=False)
    across = 400.0 * (np.arange(8_000) + 0.5) / 8_000
    power = [float(np.mean(_disc(np.hypot(row[:, None], across)) ** 2)) for row in k]
    assert math.log(power[1] / power[0]) / math.log(4.0) == pytest.approx(-5.0, abs=0.1)


def _disc(wavenumber: np.ndarray) -> np.ndarray:
    """The transform of the autocorrelation of a disc of unit diameter, (pi J_1(k/2) / k)^2."""
    return (math.pi * scipy.special.j1(0.5 * wavenumber) / wavenumber) ** 2


# What is written.
@pytest.mark.slow
def test_the_pages_are_what_the_claims_say(every: dict[str, list[Claim]], evaluated: None) -> None:
    for name, found in every.items():
        ledger = Ledger(LEDGERS[name])
        assert pages.place(ledger).read_text(encoding="utf-8") == pages.written(ledger, found)


@pytest.mark.slow
def test_json_has_a_row_for_every_number(
    claims: dict[str, Claim], evaluated: None, capsys: pytest.CaptureFixture[str]
) -> None:
    assert program.main(["--json"]) == 0
    rows = json.loads(capsys.readouterr().out, parse_constant=pytest.fail)["claims"]
    assert len(rows) == sum(len(claim.numbers) for claim in claims.values())
    for row in rows:
        assert row["verdict"] == claims[row["id"]].verdict
        assert math.isfinite(row["simulated"])
        assert all(row[key] for key in ("source", "statement", "quantity", "number", "because"))
        assert (ROOT / row["scenario"]).is_file()
    assert {row["id"]: row["range"] for row in rows}["jibiki2001"] == [0.0, None]
    assert {row["id"]: row["exact"] for row in rows}["zouabi2016_fast"] is None


@pytest.mark.slow
def test_no_page_is_written_where_a_verdict_is_another(
    every: dict[str, list[Claim]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    wrong = replace(every["paper"][-1], expected="does not hold")
    changed = {**every, "paper": [*every["paper"][:-1], wrong]}
    monkeypatch.setattr(Ledger, "claims", lambda ledger: iter(changed[ledger.path.stem]))
    monkeypatch.setattr(pages, "DOCS", tmp_path)
    assert program.main([]) == 3
    assert "paper: few_or_many: holds, expected: does not hold\n" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_exponents_under_a_load_are_judged_by_their_identity() -> None:
    rows = pages.field_parts(Ledger(LEDGERS["field"]), [])["rows"]
    assert "$n$ 0.52 to 0.63 | 0.63 to 0.67 | 0.76 to 0.815 | | disagrees |" in rows
    assert rows.count("| agrees |") == 2


# How a verdict follows from numbers.
NEAR_2 = PooledEstimate(value=2.1, standard_error=0.1, runs=8)


def _claim(exact: float = 2.0, simulated: PooledEstimate = NEAR_2, **claimed: Any) -> Claim:
    found = Number(simulated, exact)
    number = Claimed(name="exponent", number="exponent", found=found, **{"range": (1.9, 2.2), **claimed})
    return Claim(
        id="row",
        source=Source(label="Someone", name="Someone 1956"),
        statement="It is 2.",
        because="It is.",
        expected="holds",
        scenario="mean",
        numbers=(number,),
        words={name: name for name in ("holds", "corrected", "fails", "untested", "unsettled")},
    )


@pytest.mark.parametrize(
    ("verdict", "claim"),
    [
        ("holds", _claim()),
        ("holds", _claim(nan)),
        ("unsettled", _claim(3.0)),
        ("fails", _claim(range=(2.05, 2.2))),
        ("corrected", _claim(range=(2.05, 2.2), near=(1.9, 2.2))),
        ("fails", _claim(nan, range=(-inf, 2.2))),
        ("holds", _claim(range=(1.5, inf))),
        ("fails", _claim(nan, range=(2.5, 2.6))),
        ("untested", _claim(range=None)),
        ("untested", replace(_claim(), readings=2)),
        ("fails", replace(_claim(range=(2.05, 2.2)), readings=2)),
    ],
)
def test_a_verdict_follows_from_exact_number_and_interval(verdict: str, claim: Claim) -> None:
    assert claim.verdict == verdict
    assert unexpected([claim]) == ([] if verdict == "holds" else [f"row: {verdict}, expected: holds"])
    assert as_row(claim, claim.numbers[0])["verdict"] == verdict


def test_agreement_is_as_strict_as_four_standard_deviations_of_a_normal_number() -> None:
    many, few = (PooledEstimate(value=0.0, standard_error=1.0, runs=runs) for runs in (100_000, 4))
    assert _claim(3.99, many).numbers[0].agrees
    assert not _claim(4.01, many).numbers[0].agrees
    assert _claim(4.5, few).numbers[0].agrees, "few runs know their own error badly"


def test_a_difference_and_an_exponent_have_the_errors_of_both_their_points() -> None:
    near = PooledEstimate(value=3.0, standard_error=0.3, runs=8)
    far = PooledEstimate(value=12.0, standard_error=0.6, runs=4)
    assert (Number(far, nan) - Number(near, nan)).simulated == replace(far, value=9.0, standard_error=0.45**0.5)
    found = exponent(Number(near, 3.0), Number(far, 48.0), 4.0)
    assert (found.simulated.value, found.simulated.runs) == (pytest.approx(1.0), 4)
    assert found.simulated.standard_error == pytest.approx((0.1**2 + 0.05**2) ** 0.5 / log(4.0))
    half = 2.0 - 0.5 * found
    assert (half.exact, half.simulated.value) == (pytest.approx(1.0), pytest.approx(1.5))
    assert half.simulated.standard_error == pytest.approx(0.5 * found.simulated.standard_error)
    assert exponent(Number(far, nan), Number(near, nan), 0.25).simulated.standard_error > 0.0
