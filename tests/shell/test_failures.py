"""What is left when writing, printing or reading fails, and in tampered folders."""

import os
import re
import shutil
import subprocess
from pathlib import Path
from random import Random

import pytest
from fuzz_results import DAMAGES

import rubnoise
from rubnoise.errors import RubnoiseError
from tests.frozen import examples
from tests.shell.tampered import TABLE
from tests.shell.terminal import CONTACT, call, command, start

# What is left when writing, printing or reading fails: one line, an exit code, no half file.
SHORT = Path("../given/contact.toml")


@pytest.mark.slow
@pytest.mark.parametrize("unbuffered", ["", "1"])
@pytest.mark.parametrize(
    "asked", [("theory", SHORT, "--json"), ("check", SHORT), ("schema",)], ids=lambda words: words[0]
)
def test_a_command_ends_silently_in_a_pipe_that_head_has_closed(
    here: Path, asked: tuple[str | Path, ...], unbuffered: str
) -> None:
    shown = start(command(*asked), {"PYTHONUNBUFFERED": unbuffered}, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    assert shown.stdout is not None
    os.read(shown.stdout.fileno(), 100)
    shown.stdout.close()
    assert shown.communicate(timeout=60)[1] == b""
    assert shown.returncode in {0, 1}  # a short answer may be in the pipe before


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="there is no /dev/full here")
def test_an_output_that_is_full_is_told_in_a_line(here: Path) -> None:
    with Path("/dev/full").open("w") as full:
        done = start(command("check", SHORT), stdout=full, stderr=subprocess.PIPE, text=True)
    _, said = done.communicate()
    assert (done.returncode, said) == (1, "output: No space left on device\n")


@pytest.mark.slow
def test_names_that_a_terminal_cannot_show_are_escaped(here: Path) -> None:
    done = subprocess.run(
        command("check", SHORT, "--set", "title=friction of µm"),
        capture_output=True,
        check=False,
        env=os.environ | {"PYTHONIOENCODING": "ascii"},
    )
    assert (done.returncode, done.stderr) == (0, b"")
    assert rb"friction of \xb5m" in done.stdout


# Whatever a folder of a sweep says, every command answers in a sentence: no internal error, no memory for nothing.
SWEEPS = {"runs": CONTACT + TABLE, "summary": CONTACT + TABLE.replace("replicates", 'keep = "summary"\nreplicates')}
COMMANDS: dict[str, tuple[str, ...]] = {
    "info": ("info", "d"),
    "info --json": ("info", "d", "--json"),
    "info --figures": ("info", "d", "--figures", "real_contact_area_std", "--over", "interface.mean_junction_count=10"),
    "verify": ("verify", "d"),
    "sweep": ("sweep", "s.toml", "-o", "d", "--jobs", "1"),
    "xarray": (),
    "plot": ("plot", "d", "-o", "d.svg"),
    "page": ("page", "d", "-o", "d.html"),
}
CASES = [
    pytest.param(keep, name, seed, id=f"{name}-{keep}-{seed}")
    for keep in SWEEPS
    for name in COMMANDS
    for seed in range(examples(1, 3))
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


@pytest.mark.slow("verify-runs-0", "sweep-runs-0")
@pytest.mark.parametrize(("keep", "name", "seed"), CASES)
def test_a_sweep_that_was_tampered_with_is_answered_in_a_sentence(
    folders: Path, tmp_path: Path, keep: str, name: str, seed: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    shutil.copytree(folders / keep, tmp_path / keep)
    monkeypatch.chdir(tmp_path / keep)
    what = f"damage {seed} to the index"
    index, random = Path("d/index.h5"), Random(seed)  # noqa: S311  (damage is no secret)
    content = bytearray(index.read_bytes())
    random.choice(DAMAGES)(content, index.read_bytes(), random)
    index.write_bytes(content)
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
