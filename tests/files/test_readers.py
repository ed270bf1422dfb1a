"""Other tools read a result: the blocks of docs/reading.md, and viewers that follow NeXus."""

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import h5py
import pytest

import rubnoise

# The file that the page is about, made by the program as it is.
FIG5 = Path(__file__).parents[2] / "scenarios" / "paper" / "fig5.toml"


@pytest.fixture(scope="session", params=["none", "gzip"])
def kept_run(tmp_path_factory: pytest.TempPathFactory, request: pytest.FixtureRequest) -> Path:
    """Return the beginning of Figure 5: its first junctions are those of the whole run."""
    path = tmp_path_factory.mktemp("reading") / "fig5.h5"
    scenario = rubnoise.load(FIG5, ['sliding.distance="40 um"', f'output.compression="{request.param}"'])
    rubnoise.run(scenario, path, command=["rubnoise", "run", "fig5.toml"]).close()
    return path


@pytest.fixture(scope="session")
def two_way_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with the beginning of Figure 5 with two-way coupling, as fig5_two_way.h5."""
    folder = tmp_path_factory.mktemp("two_way")
    scenario = rubnoise.load(FIG5.with_name("fig5_two_way.toml"), ['sliding.distance="1 mm"', "run.engine=batch"])
    rubnoise.run(scenario, folder / "fig5_two_way.h5").close()
    return folder


@pytest.fixture
def folder(kept_run: Path, tmp_path: Path) -> Path:
    """Return a folder with nothing but fig5.h5 in it."""
    shutil.copy(kept_run, tmp_path / "fig5.h5")
    return tmp_path


# The blocks of code of docs/reading.md, by heading and language.
PAGE = Path(__file__).parents[2] / "docs" / "reading.md"
SECTION = re.compile(r"^## (.+?)\n(.*?)(?=^## |\Z)", re.MULTILINE | re.DOTALL)
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
ROW = re.compile(r"^\| `(\w+)` \| (\S+) \| (\S+) \|$", re.MULTILINE)


def blocks() -> dict[str, tuple[str, str]]:
    """Return language and code of every block; a section's second block has " 2" behind its name, and so on."""
    return {
        f"{title} {number}" if number > 1 else title: (language, code)
        for title, text in SECTION.findall(PAGE.read_text(encoding="utf-8"))
        for number, (language, code) in enumerate(BLOCK.findall(text), start=1)
    }


def printed_row() -> dict[str, tuple[str, float]]:
    """Return unit and value of every column of the junction that the page takes out."""
    return {name: (unit, float(value)) for name, unit, value in ROW.findall(PAGE.read_text(encoding="utf-8"))}


# Other tools read a result: the blocks of docs/reading.md, and viewers that follow NeXus.
# Every block of docs/reading.md, run as it stands by the tool it is for, finds the junction that the page shows.
JUNCTION = 17
AREA_AT_3_UM = 23.23979
FOUND = ("birth_distance", "death_distance", "diameter", "max_area")
NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")
MATLAB_STAND_INS = Path(__file__).parent / "matlab"


@dataclass(frozen=True, slots=True, kw_only=True)
class Reader:
    """How a block is run, whether that is possible here, and what to install where it is not."""

    command: tuple[str, ...]
    is_there: Callable[[], bool]
    install: str


def _python(*packages: str) -> Reader:
    return Reader(
        command=(sys.executable, "-W", "error", "-c"),
        is_there=lambda: all(find_spec(package) for package in packages),
        install=f"pip install {' '.join(packages)}",
    )


def _octave(*options: str) -> Reader:
    return Reader(
        command=("octave-cli", "--quiet", "--norc", *options, "--eval"),
        is_there=lambda: shutil.which("octave-cli") is not None,
        install="apt install octave",
    )


def _r(package: str, debian: str) -> Reader:
    return Reader(command=("Rscript", "-e"), is_there=lambda: _has_r(package), install=f"apt install {debian}")


@cache
def _has_r(package: str) -> bool:
    asked = ("Rscript", "-e", f"stopifnot(requireNamespace('{package}'))")
    return (
        shutil.which("Rscript") is not None and not subprocess.run(asked, capture_output=True, check=False).returncode
    )


READERS = {
    "h5py": _python("h5py"),
    "xarray": _python("xarray", "h5netcdf"),
    "pandas": _python("h5py", "pandas"),
    "polars": _python("h5py", "polars"),
    "Octave": _octave(),
    "MATLAB": _octave("--path", str(MATLAB_STAND_INS)),
    "R": _r("rhdf5", "r-bioc-rhdf5"),
    "R 2": _r("hdf5r", "r-cran-hdf5r"),
    "h5dump": Reader(
        command=("sh", "-ec"), is_there=lambda: shutil.which("h5dump") is not None, install="apt install hdf5-tools"
    ),
}
AREA_READERS = {
    "The area at any distance": READERS["h5py"],
    "The area at any distance 2": READERS["Octave"],
    "The area at any distance 3": READERS["R"],
}

MOTION_READERS = {
    "A slider that pushes back": _python("h5py", "matplotlib"),
    "A slider that pushes back 2": _python("xarray", "h5netcdf"),
    "A slider that pushes back 3": READERS["h5dump"],
}


def _numbers(reader: Reader, code: str, folder: Path) -> list[float]:
    """Run a block in a folder and return every number it prints."""
    if not reader.is_there():
        pytest.skip(f"not installed here; {reader.install}")
    done = subprocess.run(
        [*reader.command, code],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "LC_ALL": "C.UTF-8"},
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return [float(number) for number in NUMBER.findall(done.stdout)]


def _holds(printed: list[float], wanted: float) -> bool:
    """Return whether a number was printed, to the five digits that Octave shows."""
    return any(abs(number - wanted) <= 5e-5 * abs(wanted) for number in printed)


def _row(folder: Path, number: int) -> dict[str, float]:
    with h5py.File(folder / "fig5.h5") as file:
        return {name: column[number].item() for name, column in file["junctions"].items()}


def test_every_block_of_the_page_has_its_reader() -> None:
    assert set(blocks()) == READERS.keys() | AREA_READERS.keys() | MOTION_READERS.keys()


@pytest.mark.slow
@pytest.mark.parametrize("name", READERS)
def test_a_reader_finds_the_junction(name: str, folder: Path) -> None:
    printed = _numbers(READERS[name], blocks()[name][1], folder)
    row, neighbour = _row(folder, JUNCTION), _row(folder, JUNCTION + 1)
    assert [column for column in FOUND if not _holds(printed, row[column])] == []
    assert not all(_holds(printed, neighbour[column]) for column in FOUND)


@pytest.mark.slow("gzip-The area at any distance", "gzip-The area at any distance 3")
@pytest.mark.parametrize("name", AREA_READERS)
def test_a_reader_finds_its_area(name: str, folder: Path) -> None:
    printed = _numbers(AREA_READERS[name], blocks()[name][1], folder)
    assert _holds(printed, AREA_AT_3_UM)


@pytest.mark.slow
def test_a_reader_draws_a_slider_that_pushes_back(two_way_folder: Path) -> None:
    name = "A slider that pushes back"
    code = blocks()[name][1]
    assert len([line for line in code.splitlines() if line.strip()]) <= 7
    seen = code + "print(*plt.gca().lines[0].get_ydata()[[0, 500]])\nprint(len(plt.gca().collections[0].get_paths()))\n"
    *places, spans = _numbers(MOTION_READERS[name], seen, two_way_folder)
    with h5py.File(two_way_folder / "fig5_two_way.h5") as file:
        assert places == [file["slider/displacement"][row].item() for row in (0, 500)]
        stuck = file["slider/phase"][:10_000] == 1
        assert spans == (stuck[1:] & ~stuck[:-1]).sum() + stuck[0] > 0
    assert (two_way_folder / "sticks.png").stat().st_size > 5000


@pytest.mark.slow
def test_a_reader_finds_landmarks(two_way_folder: Path) -> None:
    with h5py.File(two_way_folder / "fig5_two_way.h5") as file:
        kind, time = file["landmarks/kind"][:], file["landmarks/time"][:]
    lasts = [later - earlier for what, earlier, later in zip(kind, time, time[1:], strict=False) if what == 0]
    name = "A slider that pushes back 2"
    assert _numbers(MOTION_READERS[name], blocks()[name][1], two_way_folder) == [pytest.approx(max(lasts))]
    name = "A slider that pushes back 3"
    printed = _numbers(MOTION_READERS[name], blocks()[name][1], two_way_folder)
    assert all(_holds(printed, wanted) for wanted in time[:4].tolist())


def test_the_page_shows_the_numbers_of_the_file(folder: Path) -> None:
    shown, row = printed_row(), _row(folder, JUNCTION)
    assert shown.keys() == row.keys() - {"junction"}
    with h5py.File(folder / "fig5.h5") as file:
        for name, (unit, value) in shown.items():
            assert value == pytest.approx(row[name], rel=1e-6)
            assert unit == file["junctions"][name].attrs["units"].decode()
