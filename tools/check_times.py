"""Measure the CPU time of cases and name those whose mark lies: `dev.py check times`.

It measures everyday cases and names slow ones that are not marked as slow. With `--all` it measures every case, and
names marked tests of which every case is fast, too. Nothing else should run beside it. What a process does once, such
as loading a library, is no case's own: what seems slow is measured again in another order, and the smaller time counts.
"""

import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT))

from tests.times import LIMIT, Times  # noqa: E402

TOLERANCE = 3.0
"""Unmarked cases may take so many times the limit, and marked ones so many times less: machines differ."""


def main(arguments: list[str]) -> int:
    """Name the cases whose mark lies; return 1 if a test fails or there are such cases."""
    if arguments not in ([], ["--all"]):
        print("check times takes no arguments but --all", file=sys.stderr)
        return 2
    with tempfile.TemporaryDirectory() as folder:
        times = measured(["--slow"] if arguments else [], Path(folder))
        found = confirmed(times, Path(folder))
    seconds = times.seconds()
    lies = [f"{cost:6.2f} s  {case}" for case, cost in found.items()]
    lies += [f"{cost:6.2f} s  {test} is marked as slow" for test, cost in needless(times).items()]
    print(*lies, f"{len(lies)} marks lie; {len(seconds)} cases take {sum(seconds.values()):.0f} s of CPU", sep="\n")
    return 1 if lies else 0


def measured(words: list[str], folder: Path) -> Times:
    """Run tests and return what their cases took; ends this program if one fails."""
    path = folder / "times.json"
    command = [sys.executable, "-m", "pytest", "--numprocesses=auto", "--dist=worksteal", f"--times={path}", *words]
    if code := subprocess.call(command, cwd=ROOT):
        raise SystemExit(code)
    return Times.read(path)


def confirmed(times: Times, folder: Path) -> dict[str, float]:
    """Return the unmarked cases that are slow on any machine and in another order, with the smaller of both times."""
    found = {case: cost for case, cost in times.above(TOLERANCE * LIMIT).items() if case not in times.slow}
    if not found:
        return {}
    cases = folder / "cases.txt"
    cases.write_text("\n".join(reversed(found)), encoding="utf-8")
    again = measured([f"@{cases}"], folder).above(TOLERANCE * LIMIT)
    return {case: min(cost, again[case]) for case, cost in found.items() if case in again}


def needless(times: Times) -> dict[str, float]:
    """Return the marked tests of which no case is slow on any machine, with the time of their slowest case."""
    slowest: dict[str, float] = {}
    for case, cost in times.seconds().items():
        if case in times.slow:
            test = case.partition("[")[0]
            slowest[test] = max(cost, slowest.get(test, 0.0))
    return {test: cost for test, cost in slowest.items() if cost < LIMIT / TOLERANCE}


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
