"""What the numbers were measured on: processor and versions, nothing that names whose machine it is."""

import os
import platform
import re
import subprocess
from importlib.metadata import version
from pathlib import Path

PACKAGES = ("numpy", "scipy", "numba", "simpy", "h5py", "superposed-pulses", "ciw", "salabim")


def processor() -> str:
    """Return the processor's model, as far as the system tells it."""
    listing = Path("/proc/cpuinfo")
    if listing.exists() and (found := re.search(r"^model name\s*:\s*(.+)$", listing.read_text(), re.MULTILINE)):
        return found[1].strip()
    if platform.system() == "Darwin":
        asked = ["sysctl", "-n", "machdep.cpu.brand_string"]
        return subprocess.run(asked, capture_output=True, text=True, check=False).stdout.strip()
    return platform.machine()


def compiler(*, available: bool) -> str:
    """Return the version of gcc, or that there is none."""
    if not available:
        return "no gcc"
    told = subprocess.run(["gcc", "-dumpfullversion"], capture_output=True, text=True, check=False).stdout
    return f"gcc {told.strip()}"


def described(*, gcc: bool) -> tuple[str, str]:
    """Return a line on the processor and one on the versions."""
    cores = os.cpu_count()
    python = f"Python {platform.python_version()}"
    versions = [python, *(f"{name} {version(name)}" for name in PACKAGES), compiler(available=gcc)]
    busy = f"load average {os.getloadavg()[0]:.1f} before it began"
    return f"{processor()}, {cores} cores, {platform.system()} on {platform.machine()}, {busy}", ", ".join(versions)
