"""Measure the CPU time of cases and name those whose mark lies: `dev.py check times`.

It measures everyday cases and names slow ones that are not marked as slow. With `--all` it measures every case, and
names marked tests of which every case is fast, too. Nothing else should run beside it.
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
    """Name the cases whose mark lies; return 1 if there are such cases, and the code of pytest if a test fails."""
    if arguments not in ([], ["--all"]):
        print("check times takes no arguments but --all", file=sys.stderr)
        return 2
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "times.json"
        command = [sys.executable, "-m", "pytest", "--numprocesses=auto", "--dist=worksteal", f"--times={path}"]
        if code := subprocess.call([*command, *["--slow"] * bool(arguments)], cwd=ROOT):
            return code
        times = Times.read(path)
    seconds = times.seconds()
    lies = [f"{cost:6.2f} s  {case}" for case, cost in times.above(TOLERANCE * LIMIT).items() if case not in times.slow]
    slowest: dict[str, float] = {}
    for case in times.slow & seconds.keys():
        test = case.partition("[")[0]
        slowest[test] = max(seconds[case], slowest.get(test, 0.0))
    needless = {test: cost for test, cost in slowest.items() if cost < LIMIT / TOLERANCE}
    lies += [f"{cost:6.2f} s  {test} is marked as slow" for test, cost in needless.items()]
    print(*lies, f"{len(lies)} marks lie; {len(seconds)} cases take {sum(seconds.values()):.0f} s of CPU", sep="\n")
    return int(bool(lies))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
