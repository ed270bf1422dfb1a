"""What a terminal shows of a sweep, and when a signal is obeyed."""

import signal

import pytest

from rubnoise.cli import progress
from rubnoise.cli.progress import SIGNALS, watching_sweep
from rubnoise.errors import RunStopped
from rubnoise.sweep.conduct import SweepProgress


def _standing(done: int, *, failed: int = 0, before: int = 0) -> SweepProgress:
    return SweepProgress(runs=1000, done=done, failed=failed, before=before)


def test_the_line_tells_runs_failures_and_the_time_to_go(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    clock = iter([100.0, 100.0, 110.0, 120.0])
    monkeypatch.setattr(progress.time, "monotonic", lambda: next(clock))
    with watching_sweep(shown=True) as watch:
        watch(_standing(200, before=200))
        watch(_standing(300, before=200))
        watch(_standing(390, failed=10, before=200))
    lines = [line.rstrip() for line in capsys.readouterr().err.split("\r") if line.strip()]
    # What was done before says nothing of how long the rest takes.
    assert lines == [
        " 20%  200 of 1,000 runs",
        " 30%  300 of 1,000 runs  1:10 to go",
        " 40%  400 of 1,000 runs, 10 failed  1:00 to go",
    ]


def test_nothing_is_shown_where_nobody_looks(capsys: pytest.CaptureFixture[str]) -> None:
    with watching_sweep(shown=False) as watch:
        watch(_standing(1))
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("number", SIGNALS)
def test_a_signal_is_obeyed_when_the_sweep_next_tells_how_far_it_is(number: signal.Signals) -> None:
    with watching_sweep(shown=False) as watch:
        watch(_standing(1))
        signal.raise_signal(number)
        assert signal.getsignal(number) == signal.SIG_DFL  # the second one leaves at once
        with pytest.raises(RunStopped) as stopped:
            watch(_standing(2))
    assert stopped.value.exit_code == 128 + number


@pytest.mark.parametrize("number", SIGNALS)
def test_a_signal_before_the_start_is_obeyed_at_once(number: signal.Signals) -> None:
    with watching_sweep(shown=False), pytest.raises(RunStopped):
        signal.raise_signal(number)
