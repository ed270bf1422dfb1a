"""Whatever a folder of a sweep says, every command answers in a sentence: no internal error, no memory for nothing."""

import re
import shutil
from pathlib import Path

import pytest

import rubnoise
from rubnoise.errors import RubnoiseError
from tests.cli.swept import TABLE
from tests.cli.tampered import tampered
from tests.cli.terminal import CONTACT, call

SWEEPS = {"runs": CONTACT + TABLE, "summary": CONTACT + TABLE.replace("replicates", 'keep = "summary"\nreplicates')}
COMMANDS: dict[str, tuple[str, ...]] = {
    "info": ("info", "d"),
    "info --json": ("info", "d", "--json"),
    "info --figures": ("info", "d", "--figures", "real_contact_area_std", "--over", "interface.mean_junction_count=10"),
    "verify": ("verify", "d"),
    "sweep": ("sweep", "s.toml", "-o", "d", "--jobs", "1"),
    "sweep --merge": ("sweep", "s.toml", "-o", "d", "--jobs", "1", "--merge"),
    "xarray": (),
    "plot": ("plot", "d", "-o", "d.svg"),
    "view": ("view", "d", "-o", "d.html"),
    "report": ("report", "d", "-o", "d.html"),
}
PICTURES = ("plot", "view", "report")
"""Commands that take some seconds."""

CASES = [
    pytest.param(keep, name, seed, id=f"{name}-{keep}-{seed}")
    for keep in SWEEPS
    for name in COMMANDS
    for seed in range(12 if name in PICTURES else 60)
]


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a sweep of each kind."""
    place = tmp_path_factory.mktemp("sweeps")
    for keep, text in SWEEPS.items():
        (place / keep).mkdir()
        (place / keep / "s.toml").write_text(text, encoding="utf-8")
        assert call("sweep", place / keep / "s.toml", "-o", place / keep / "d", "--jobs", "1", "-q").code == 0
    return place


@pytest.mark.parametrize(("keep", "name", "seed"), CASES)
def test_a_sweep_that_was_tampered_with_is_answered_in_a_sentence(
    folders: Path, tmp_path: Path, keep: str, name: str, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(folders / keep, tmp_path / keep)
    monkeypatch.chdir(tmp_path / keep)
    what = tampered(Path("d"), seed)
    if name == "xarray":
        _ask_from_python(what)
        return
    answer = call(*COMMANDS[name])
    assert answer.code in {0, 1, 2, 3}, what
    assert not re.search("internal error|Traceback|out of memory", answer.err), f"{what}: {answer.err}"
    if answer.code in {1, 2}:
        assert 1 <= answer.err.count("\n") <= 6, f"{what}: {answer.err}"
        assert len(answer.err) < 1500, what
        assert not any(Path().glob("d.*")), what


def _ask_from_python(what: str) -> None:
    try:
        with rubnoise.open_sweep("d") as sweep:
            repr(sweep)
            assert sweep.to_xarray().sizes["replicate"] <= len(sweep.runs), what
            for figure in sweep.figures:
                sweep.estimates(figure)
            for point in range(len(sweep.points)):
                sweep.scenario(point)
            assert len(sweep.failures) <= len(sweep.runs), what
    except RubnoiseError as refused:
        assert str(refused).startswith("d"), what  # noqa: PT017
