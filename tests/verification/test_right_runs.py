"""Right runs are called outside as rarely as is promised; `python tools/right_runs.py` makes some thousands of them."""

import sys
from collections.abc import Callable

import pytest

from rubnoise.analysis.comparing.findings import Comparison
from rubnoise.errors import ScenarioRefused
from rubnoise.model import Model
from tests.verification.seeds import seed_of
from tools import right_runs

EVERY = {f"{kind}, {name}": changes for kind, cases in right_runs.KINDS.items() for name, changes in cases.items()}


@pytest.mark.parametrize("case", EVERY)
def test_every_case_is_a_contact(case: str) -> None:
    model = right_runs.model_of(EVERY[case])
    assert model.distance > 0.0


def test_cases_differ() -> None:
    assert len({repr(right_runs.model_of(changes)) for changes in EVERY.values()}) == len(EVERY) >= 50
    counts = {right_runs.model_of(changes).mean_junction_count for changes in right_runs.SPARSE.values()}
    assert counts == {0.05, 0.1, 0.2, 0.5, 1.0}


def test_runs_of_a_case_are_counted() -> None:
    changes = right_runs.SPARSE["0.2 over 600 mm"]
    count = right_runs.counted(changes, range(seed_of("right"), seed_of("right") + 3))
    assert (count.runs, count.alarms) == (3, {})
    assert count.scores["spectrum"] > count.scores["birth_count"] == 3


def test_a_wrong_run_is_an_alarm(monkeypatch: pytest.MonkeyPatch) -> None:
    spoil(monkeypatch, lambda model: right_runs.model_of([*right_runs.SPARSE["1 over 100 mm"], OTHER]))
    count = right_runs.counted(right_runs.SPARSE["1 over 100 mm"], [1, 2])
    assert set(count.alarms) == {1, 2}
    assert "birth_count" in count.alarms[1]
    assert count.far["birth_count"] == 2


OTHER = "interface.mean_junction_count=1.2"


def spoil(monkeypatch: pytest.MonkeyPatch, wrong: Callable[[Model], Model]) -> None:
    from rubnoise.analysis import comparison

    def compare(model: Model, rows: object) -> Comparison:
        return comparison.compare(wrong(model), rows)  # type: ignore[arg-type]

    monkeypatch.setattr(right_runs, "compare", compare)


def test_what_is_promised_is_a_thousandth() -> None:
    assert right_runs.chance_of(0, 2000) == 1.0
    assert right_runs.chance_of(1, 1) == pytest.approx(1e-3)
    assert right_runs.chance_of(2, 2000) == pytest.approx(0.594, abs=1e-3)
    assert right_runs.chance_of(8, 2000) > right_runs.CHANCE > right_runs.chance_of(9, 2000)


@pytest.mark.parametrize(("wrong", "code"), [(False, 0), (True, 1)])
def test_too_many_alarms_are_an_exit_code(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], *, wrong: bool, code: int
) -> None:
    short = right_runs.SPARSE["1 over 100 mm"]
    monkeypatch.setattr(right_runs, "KINDS", {"sparse": {"one": short}, "dense": {"other": ()}})
    monkeypatch.setattr(sys, "argv", ["right_runs.py", "--runs", "2", "--kind", "sparse"])
    if wrong:
        spoil(monkeypatch, lambda model: right_runs.model_of([*short, OTHER]))
    assert right_runs.main() == code
    told = capsys.readouterr().out
    assert f"{2 * wrong} alarms in 2 right runs" in told
    assert "other" not in told


def test_a_wrong_case_is_refused() -> None:
    with pytest.raises(ScenarioRefused):
        right_runs.model_of(["interface.mean_junction_count=-1"])
