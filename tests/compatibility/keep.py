"""Write the files that stand here for the present format version; those of earlier versions stay as they are.

From the root, after FORMAT_VERSION has been raised: `python -m tests.compatibility.keep`, then commit what is new.
"""

from pathlib import Path

import rubnoise
from rubnoise.storage import provenance
from rubnoise.storage.schema import FORMAT_VERSION

HERE = Path(__file__).parent
SCENARIOS = {"whole": "", "bare": "_bare"}


def main() -> None:
    """Run both scenarios into files that say nothing of the machine they were made on; refuses to replace one."""
    provenance.environment = lambda: {"platform": "Linux", "machine": "x86_64", "cpu_count": 1}
    for name, suffix in SCENARIOS.items():
        command = ["rubnoise", "run", f"{name}.toml"]
        path = HERE / f"format_{FORMAT_VERSION}{suffix}.h5"
        rubnoise.run(rubnoise.load(HERE / f"{name}.toml"), path, command=command).close()


if __name__ == "__main__":
    main()
