"""Each call of refusals.txt is refused, and each of answers.txt answered, as it says there; none makes anything.

`.venv/bin/python -m pytest -n 0 --freeze tests/shell/test_refusals.py` writes those words anew.
"""

import re
import shutil
from importlib.util import find_spec
from pathlib import Path
from shlex import split

import pytest

import rubnoise
from tests.frozen import Said
from tests.shell.terminal import CONTACT, WITH_SLIDER, call, names
from tests.unit.tampering import lives_file

SAID = Said(Path(__file__).with_name("refusals.txt"))
ANSWERS = Said(Path(__file__).with_name("answers.txt"))
MANY = """\
[sweep]
replicates = 2
[sweep.grid]
interface.mean_junction_count = [10, 20]
interface.mean_real_contact_area = ["100 um^2", "200 um^2"]
"""
WITH_SURFACES = find_spec("SurfaceTopography") is not None
BROKEN = "format = 1\n[interface]\nmean_junction_count = -1\n"
SWEPT = '[sweep]\nkeep = "summary"\n[sweep.grid]\ninterface.mean_junction_count = [10, 20]\n'


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("made")
    texts = {
        "contact": CONTACT,
        "slider": WITH_SLIDER,
        "sweep": CONTACT + SWEPT,
        "many": CONTACT + MANY,
        "broken": BROKEN,
    }
    for name, text in texts.items():
        (folder / f"{name}.toml").write_text(text, encoding="utf-8")
    for name in ("contact", "slider"):
        rubnoise.run(rubnoise.load(folder / f"{name}.toml"), folder / f"{name}.h5").close()
    rubnoise.sweep(folder / "sweep.toml", folder / "swept", jobs=1).close()
    lives_file(folder / "l.h5").close()
    (folder / "words.txt").write_text("no surface\n" * 50, encoding="utf-8")
    if WITH_SURFACES:
        rubnoise.Surface.synthesise(points=512, rolloff="64 um", cutoff="8 um", seed=1).save(folder / "1.nc")
    return folder


READING = (
    "run contact.toml -o contact.toml",
    "run contact.toml -o contact.toml --dry-run",
    "run above.toml -o contact.toml",
    "run sized.toml -o sizes.csv",
    "page run.html --as lesson -o run.html",
    "infer contact.h5 -o contact.h5",
    "infer contact.h5 --report contact.h5",
    "surface scan.nc --cutoff 8um --load 2N --hardness 1GPa -o scan.nc",
    "surface scan.nc scan.nc --cutoff 8um --load 2N --hardness 1GPa --report scan.nc",
    "report run.html -o run.html",
    "view run.html -o run.html",
    "plot run.png -o run.png",
    "plot slider.h5 slider --with run.png -o run.png",
    "junction run.png 1 --plot run.png",
    "theory contact.png --plot contact.png",
    "listen run.wav -o run.wav",
)


@pytest.fixture
def place(made: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Stand in a copy of the folder with what commands read."""
    monkeypatch.chdir(shutil.copytree(made, tmp_path / "place"))
    return tmp_path / "place"


@pytest.mark.parametrize("words", READING)
def test_force_does_not_replace_what_is_read(place: Path, words: str) -> None:
    for name in ("run.html", "run.png", "run.wav"):
        shutil.copy("slider.h5", name)
    shutil.copy("contact.toml", "contact.png")
    Path("scan.nc").write_bytes(b"a scan")
    Path("sizes.csv").write_text("diameter_um\n3\n4\n", encoding="utf-8")
    Path("above.toml").write_text('format = 1\nextends = "contact.toml"\n', encoding="utf-8")
    Path("sized.toml").write_text(
        'format = 1\nextends = "contact.toml"\n[diameter]\nlaw = "empirical"\nfile = "sizes.csv"\n', encoding="utf-8"
    )
    before = {path: path.read_bytes() for path in place.rglob("*") if path.is_file()}
    answer = call(*split(words), "--force")
    assert answer.code == 2
    assert "is read here" in answer.err
    assert {path: path.read_bytes() for path in place.rglob("*") if path.is_file()} == before


@pytest.mark.parametrize("words", [words for words in SAID.kept if WITH_SURFACES or " surface " not in words])
def test_wrong_words_are_refused_and_make_nothing(place: Path, words: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "100")
    before = names(place)
    answer = call(*split(words)[1:])
    assert (answer.code, answer.out, names(place)) == (2, "", before)
    told = re.sub(r"^Usage: [^$]*?\nError: ", "", answer.err.replace(f"{place}", "PLACE"))
    SAID.assert_said(words, "\n".join(" ".join(line.split()) for line in told.splitlines() if line.strip()))


@pytest.mark.parametrize("words", ANSWERS.kept)
def test_answers_are_these(made: Path, words: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(made)
    monkeypatch.setenv("COLUMNS", "80")
    before = names(made)
    answer = call(*split(words)[1:])
    assert names(made) == before
    code = f"exit code {answer.code}" if answer.code else ""
    told = re.sub(r"(peak memory +)[\d.]+ .B", r"\1that of the program too", f"{answer.out}{answer.err}{code}")
    ANSWERS.assert_said(words, told.strip("\n"))
