"""A cold first run: `dev.py check first` makes the shortest run of Figure 5 where nothing was compiled before.

With an empty cache, with a home to which nothing may be written, and in a folder with a blank in its
name. Prints a table in Markdown of seconds and outcome; exit code 1 where a run fails, or says what it should not.
"""

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

RUN = ("run", "paper/fig5", "--set", "sliding.distance=0.1 mm", "-o", "fig5.h5", "-q")
VERIFY = ("verify", "fig5.h5")


def places(folder: Path) -> Iterator[tuple[str, Path, dict[str, str], str]]:
    """Yield the name of each place, the folder of the run, what is set there, and a word that the run has to say."""
    blank, read_only = folder / "a folder", folder / "read_only"
    for each in (blank, read_only):
        each.mkdir()
    (read_only / "home").write_text("a file, so that nobody can make a folder below it", encoding="utf-8")
    yield "empty cache", folder, {"NUMBA_CACHE_DIR": str(folder / "cache")}, ""
    yield "the same again", folder, {"NUMBA_CACHE_DIR": str(folder / "cache")}, ""
    home = str(read_only / "home")
    yield (
        "no home to write to",
        read_only,
        {"HOME": home, "XDG_CACHE_HOME": home, "NUMBA_CACHE_DIR": home},
        "cannot be kept",
    )
    yield "folder with a blank", blank, {"HOME": str(blank), "NUMBA_CACHE_DIR": str(blank / "cache")}, ""


def tried(folder: Path, variables: dict[str, str], word: str) -> tuple[float, str]:
    """Return the seconds that a run takes and what is wrong with it, or "verified"."""
    begun = time.monotonic()
    made = called(RUN, folder, variables)
    seconds = time.monotonic() - begun
    if made.returncode or (word not in made.stderr if word else made.stderr):
        return seconds, f"exit code {made.returncode}: {made.stderr.strip()[-200:]}"
    checked = called(VERIFY, folder, variables)
    (folder / "fig5.h5").unlink()
    return seconds, "verified" if checked.returncode == 0 else f"not verified: {checked.stdout}"


def called(words: tuple[str, ...], folder: Path, variables: dict[str, str]) -> "subprocess.CompletedProcess[str]":
    """Call the command line in a new process."""
    command = [sys.executable, "-m", "rubnoise", *words]
    return subprocess.run(command, cwd=folder, env=os.environ | variables, capture_output=True, text=True, check=False)


def main() -> int:
    """Try each place and print its row."""
    print("| first run | seconds | outcome |\n|---|---|---|", flush=True)
    well = True
    with tempfile.TemporaryDirectory(prefix="rubnoise-first-") as folder:
        for name, place, variables, word in places(Path(folder)):
            seconds, outcome = tried(place, variables, word)
            print(f"| {name} | {seconds:.1f} | {outcome} |", flush=True)
            well &= outcome == "verified"
    return 0 if well else 1


if __name__ == "__main__":
    sys.exit(main())
