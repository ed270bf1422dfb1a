"""Measure the CPU time of cases: `dev.py check times` refuses slow ones that tests/slow.txt does not list.

With `--write` it measures every case and writes that list anew; with `--add` it measures everyday cases alone and adds
the slow ones. Nothing else should run beside it. What a process does once, such as loading a library, is no case's own:
what seems slow is measured again in another order, and the smaller time counts.
"""

import subprocess
import sys
import tempfile
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from tests.times import LIMIT, SLOW, Times, parts, slow  # noqa: E402

TOLERANCE = 3.0
"""A case that is not listed may take so many times the limit: machines differ."""
HEADER = f"""\
# Cases, tests, files and folders that wait for --all, because a case takes more than {LIMIT} s of CPU with its share of
# what it shares. Written by `python3 tools/dev.py check times --write`; do not edit.
"""


def main(arguments: list[str]) -> int:
    """Check the list, or write it; return 1 if a test fails or an unlisted case is slow."""
    if arguments not in ([], ["--add"], ["--write"]):
        print("check times takes no arguments but --add or --write", file=sys.stderr)
        return 2
    with tempfile.TemporaryDirectory() as folder:
        return write(Path(folder), every="--write" in arguments) if arguments else check(Path(folder))


def check(folder: Path) -> int:
    """Return 1 if an everyday case takes more than the limit allows on any machine."""
    times = measured([], folder)
    found = confirmed(times.above(TOLERANCE * LIMIT), TOLERANCE * LIMIT, folder)
    for case, seconds in found.items():
        print(f"{seconds:6.2f} s  {case}")
    print(f"{len(found)} of {len(times.cases)} everyday cases take more than {TOLERANCE * LIMIT} s of CPU")
    print(f"{sum(times.seconds().values()):.0f} s of CPU in all")
    return 1 if found else 0


def write(folder: Path, *, every: bool) -> int:
    """Measure every case and write the list, or measure everyday cases and add the slow ones to it."""
    times = measured(["--slow"] if every else [], folder)
    found = confirmed(times.above(LIMIT), LIMIT, folder)
    lines = sorted({*shortened(found.keys(), times.cases.keys()), *(() if every else slow())})
    SLOW.write_text(HEADER + "".join(f"{line}\n" for line in lines), encoding="utf-8")
    seconds = times.seconds()
    print(f"{len(found)} of {len(seconds)} cases are slow; {SLOW.relative_to(ROOT)} has {len(lines)} lines")
    print(f"{sum(seconds.values()):.0f} s of CPU, {sum(seconds[case] for case in found):.0f} s of them in slow cases")
    return 0


def measured(words: list[str], folder: Path) -> Times:
    """Run tests and return what their cases took; ends this program if one fails."""
    path = folder / "times.json"
    command = [sys.executable, "-m", "pytest", "--numprocesses=auto", "--dist=worksteal", f"--times={path}", *words]
    if code := subprocess.call(command, cwd=ROOT):
        raise SystemExit(code)
    return Times.read(path)


def confirmed(found: dict[str, float], limit: float, folder: Path) -> dict[str, float]:
    """Return the cases that are above a limit in another order, too, with the smaller of both times."""
    if not found:
        return {}
    cases = folder / "cases.txt"
    cases.write_text("\n".join(reversed(found)), encoding="utf-8")
    again = measured([f"@{cases}"], folder).above(limit)
    return {case: min(seconds, again[case]) for case, seconds in found.items() if case in again}


def shortened(found: Iterable[str], every: Iterable[str]) -> list[str]:
    """Return names for cases: that of a test, a file or a folder if all cases in it are among them."""
    spared = {part for case in set(every) - set(found) for part in parts(case)}
    return sorted({[part for part in parts(case) if part not in spared][-1] for case in found})


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
