"""The study of inference resumes where it stopped, counts what intervals hold, and writes the tables of the page."""

import json
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from tools.studies import inference as infer_study


def fit_of(cell: str, seed: int, value: float, *, flags: tuple[str, ...] = ()) -> dict[str, Any]:
    """Return a line of the study: N was found as ``value``, give or take 10 %, and is 20."""
    return {
        "cell": cell,
        "seed": seed,
        "cpu": 0.1,
        "refused": None,
        "flags": list(flags),
        "p": {},
        "law": "normal",
        "true": {"junction_count": 20.0},
        "estimates": {"junction_count": [value, 0.05 * value, 0.9 * value, 1.1 * value]},
    }


def test_intervals_that_hold_the_truth_are_counted() -> None:
    rows = [fit_of("normal 20", 1, 21.0), fit_of("normal 20", 2, 25.0), fit_of("normal 20", 3, 19.0)]
    assert infer_study.scores(rows, "junction_count") == (2, 3, pytest.approx(0.05))
    assert infer_study.scores(rows, "diameter") is None


def test_the_tables_of_the_page_are_written_in_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = [fit_of("normal 5", 1, 21.0), fit_of("normal 5", 2, 25.0), fit_of("auto normal", 1, 20.0)]
    rows.append(fit_of("wrong sine (zero unknown)", 1, 20.0, flags=("line",)))
    lines = [json.dumps(row) for row in rows]
    (tmp_path / "fits.jsonl").write_text("\n".join([*lines, lines[0][:40]]), encoding="utf-8")
    page = tmp_path / "page.md"
    parts = "".join(f"<!-- study: {name} -->\nold\n<!-- end -->\nkept\n" for name in ("coverage", "others", "wrong"))
    page.write_text(f"before\n{parts}after\n", encoding="utf-8")
    monkeypatch.setattr(infer_study, "PAGE", page)
    monkeypatch.setattr(infer_study, "DATA", tmp_path / "right_traces.json")
    for _ in range(2):
        infer_study.document(tmp_path)
        text = page.read_text(encoding="utf-8")
        assert "| normal, 20 % | 5 | 2 | 50.0 %, 15.0 % | | | |" in text
        assert "| `--law auto` | normal | 1 | 100.0 %, 0.0 % | | | | 0 |" in text
        assert "| a sine with noise | 1 of 1 | 0 of 0 |" in text
        assert "old" not in text
        assert (text.count("kept"), text[:6], text[-6:]) == (3, "before", "after\n")
    infer_study.table(tmp_path)
    assert "right: junction_count 50.0 % of 2, flagged or refused 0 of 2" in capsys.readouterr().out


def test_a_study_resumes_where_it_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[tuple[str, int]] = []

    def fit(job: tuple[infer_study.Cell, int]) -> dict[str, Any]:
        made.append((job[0].name, job[1]))
        return fit_of(job[0].name, job[1], 20.0)

    pool = SimpleNamespace(map=lambda function, jobs, chunksize: map(function, jobs[: chunksize * len(jobs)]))
    monkeypatch.setattr(infer_study, "ProcessPoolExecutor", lambda _jobs: nullcontext(pool))
    monkeypatch.setattr(infer_study, "fit", fit)
    infer_study.run(tmp_path, 1, 1, "long:,drift:")
    infer_study.run(tmp_path, 2, 1, "long:")
    assert sorted(made) == [("drift lognormal", 1), ("drift normal", 1), ("long normal", 1), ("long normal", 2)]


def test_traces_made_outside_are_kept_as_data_and_drawn_from_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    names = ["outside two strokes", *(f"outside 5 cycles {which}" for which in ("without", "with"))]
    rows = [fit_of(name, seed, value) for name in names for seed, value in ((1, 21.0), (2, 25.0))]
    (tmp_path / "fits.jsonl").write_text("\n".join(json.dumps(row) for row in rows), encoding="utf-8")
    page = tmp_path / "page.md"
    page.write_text("".join(f"<!-- study: {name} -->\n<!-- end -->\n" for name in ("outside", "bandwidth")))
    monkeypatch.setattr(infer_study, "PAGE", page)
    monkeypatch.setattr(infer_study, "DATA", tmp_path / "right_traces.json")
    infer_study.document(tmp_path)
    data = json.loads(infer_study.DATA.read_text(encoding="utf-8"))
    assert data["two strokes"]["held"]["junction_count"] == {"held": 1, "of": 2, "median_error": 0.15}
    assert data["two strokes"]["flagged_or_number_held"] == 1
    text = page.read_text(encoding="utf-8")
    assert '| two strokes | auto | `--strokes "5 %"` | 1 of 2, 15.0 % | | | 0 of 2 |' in text
    assert "| 5 | 1 of 2, 15.0 % | | 1 of 2, 15.0 % | |" in text


def test_the_page_shows_the_data() -> None:
    text = infer_study.PAGE.read_text(encoding="utf-8")
    data = json.loads(infer_study.DATA.read_text(encoding="utf-8"))
    for line in (*infer_study.outside_table(data), *infer_study.bandwidth_table(data)):
        assert line in text


@pytest.mark.parametrize(
    "name",
    [
        "normal 5",
        "outside two poles at 5 cycles a life",
        "outside two strokes",
        "clean fixed",
        "drift normal",
        "wrong sine (zero unknown)",
    ],
)
def test_a_cell_is_made_and_fitted(name: str) -> None:
    cell = next(each for each in infer_study.cells() if each.name == name)
    row = infer_study.fit((cell, 1))
    assert row["refused"] is None
    if cell.kind == "wrong":
        assert row["flags"]
        return
    value, error, low, high = row["estimates"]["diameter"]
    assert low < value < high
    assert abs(value - row["true"]["diameter"]) <= 4.0 * error
