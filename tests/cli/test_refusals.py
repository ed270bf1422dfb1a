"""Wrong words on the command line: each call of refusals.txt is refused as it says there, and makes nothing.

`.venv/bin/python -m pytest -n 0 --freeze tests/cli/test_refusals.py` writes those words anew.
"""

import re
import shutil
from pathlib import Path
from shlex import split

import pytest

import rubnoise
from tests.cli.terminal import CONTACT, WITH_SLIDER, call, names
from tests.frozen import Said

SAID = Said(Path(__file__).with_name("refusals.txt"))
SWEPT = '[sweep]\nkeep = "summary"\n[sweep.grid]\ninterface.mean_junction_count = [10, 20]\n'


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("made")
    texts = {"contact": CONTACT, "slider": WITH_SLIDER, "sweep": CONTACT + SWEPT}
    for name, text in texts.items():
        (folder / f"{name}.toml").write_text(text, encoding="utf-8")
    for name in ("contact", "slider"):
        rubnoise.run(rubnoise.load(folder / f"{name}.toml"), folder / f"{name}.h5").close()
    rubnoise.run_sweep(folder / "sweep.toml", folder / "swept", jobs=1).close()
    return folder


@pytest.mark.parametrize("words", SAID.kept)
def test_wrong_words_are_refused_and_make_nothing(
    made: Path, tmp_path: Path, words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    place = tmp_path / "place"
    shutil.copytree(made, place)
    monkeypatch.chdir(place)
    monkeypatch.setenv("COLUMNS", "100")
    before = names(place)
    answer = call(*split(words)[1:])
    assert (answer.code, answer.out, names(place)) == (2, "", before)
    told = re.sub("[│╭╮╰╯─]", " ", answer.err.replace(f"{place}", "PLACE"))
    said = "\n".join(" ".join(line.split()) for line in told.splitlines() if line.strip())
    SAID.assert_said(words, said)
