"""Scans in files of other programs: one surface in many forms, and what is said of those that cannot be right."""

import numpy as np
import pytest

import rubnoise
from tests.shell.terminal import call

pytest.importorskip("SurfaceTopography")

N = 40
RNG = np.random.default_rng(3)
Z = sum(np.cos(2 * np.pi * (k * np.arange(N)[:, None] + m * np.arange(32)) / 16) for k, m in ((1, 0), (1, 1), (2, 1)))
"""Heights in um at points a um apart, x first, y second."""
X, Y = np.mgrid[0:N, 0:32]
POINTS = np.c_[X.ravel(), Y.ravel(), Z.ravel()]


def written(points=POINTS, mark=" ", form="%.6g", above="", scale=(1, 1, 1)):
    """A list of points or a matrix, as text."""
    rows = "\n".join(mark.join(form % value for value in row) for row in points * scale)
    return f"{above}{rows}\n"


MATRIX = "\n".join(" ".join(f"{value:.6g}" for value in row) for row in Z.T)
SIZED = {"unit": "um", "size": "40 um x 32 um"}
HEAD = "# Channel: {}\n# Width: 40 um\n# Height: 32 um\n# Value units: {}\n"
READ = {
    "list.xyz": (written(), {"unit": "um"}),
    "millimetres.xyz": (written(scale=(1e-3, 1e-3, 1.0)), {"unit": "mm", "height_unit": "um"}),
    "shuffled.txt": (written(RNG.permutation(POINTS)), {"unit": "um"}),
    "names.csv": (written(mark=",", above="X (um),Y (um),Z (nm)\n", scale=(1, 1, 1e3)), {}),
    "four.csv": (written(np.c_[POINTS[:, 2], POINTS], ",", above="light,x [um],y [um],z [um]\n", scale=1), {}),
    "german.csv": (written(mark=";", above="X (µm);Y (µm);Z (µm)\n").replace(".", ",").encode("cp1252"), {}),
    "tabs.dat": (written(mark="\t").replace(".", ","), {"unit": "um"}),
    "utf16.txt": (written(above="# Lateral units: um\n# Value units: um\n").encode("utf-16"), {}),
    "matrix.txt": (MATRIX, SIZED),
    "dated.txt": (f"2024-05-01\n40 32\n{MATRIX}", SIZED),
    "commas.asc": (MATRIX.replace(".", ",").replace(" ", ";"), SIZED),
    "head.asc": (HEAD.format("Height", "um") + MATRIX, {}),
    "two.asc": (HEAD.format("A", "um") + MATRIX + "\n" + HEAD.format("B", "nm") + MATRIX, {"channel": "A"}),
    "half_named.asc": ("# Width: 40 um\n# Height: 32 um\n" + MATRIX, {"height_unit": "um"}),
}
"""Texts of this surface, and what is said beside them."""


def kept(folder, name, content):
    path = folder / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


@pytest.mark.parametrize("name", READ)
def test_one_surface_is_read_from_many_forms(tmp_path, name):
    content, told = READ[name]
    found = rubnoise.Surface.read(kept(tmp_path, name, content), form="none", **told)
    assert found.map.spacing == pytest.approx((1.0, 1.0))
    assert np.abs(found.heights - Z).max() < 2e-5
    notes = {
        "german.csv": ("read as Windows-1252",),
        "utf16.txt": ("read as UTF-16",),
        "two.asc": ("channel A of A, B",),
    }
    assert found.map.history == notes.get(name, ())


def test_missed_points_are_filled(tmp_path):
    """Those of which a list has no row, and those whose height is no number."""
    here = RNG.random(len(POINTS)) > 0.02
    for points in (POINTS[here], np.c_[POINTS[:, :2], np.where(here, POINTS[:, 2], np.nan)]):
        found = rubnoise.Surface.read(kept(tmp_path, "missed.xyz", written(points)), unit="um", form="none")
        assert found.map.history == (f"{(~here).sum()} missing points filled from their neighbours",)
        assert np.abs(found.heights - Z).ravel()[here].max() < 2e-5


REFUSED = {
    "steep.xyz": (written(scale=(1e-3, 1e-3, 1.0)), {"unit": "mm"}, "rms slope of"),
    "bare.txt": (MATRIX, {"unit": "um"}, 'say it: size="128 um x 128 um"'),
    "long.txt": (MATRIX, {"unit": "m", "size": "40 m x 32 m"}, "is 40 m long"),
    "none.xyz": (written(), {}, 'unit of its lengths; say it: unit="um"'),
    "flat.csv": (written(mark=",", above="X (um),Y (um),Z\n"), {}, 'unit of its heights; say it: height_unit="um"'),
    "half.asc": ("# Width: 40 um\n# Height: 32 um\n" + MATRIX, {}, 'unit of its heights; say it: height_unit="um"'),
    "cell.xyz": (written().replace("2 3 ", "2 3.1.1 "), {"unit": "um"}, "line 68: 3.1.1 is no number"),
    "short.txt": (MATRIX[:-9], SIZED, "line 32: has 39 numbers, other rows 40"),
    "twice.xyz": (written(np.r_[POINTS, POINTS[:1]]), {"unit": "um"}, "two points at one place"),
    "random.xyz": (written(RNG.random((50, 3))), {"unit": "um"}, "even grid|a grid of"),
    "two.asc": (READ["two.asc"][0], {"channel": "C"}, "channel=: C names no heights in it; these do: A, B"),
    "no.x3p": (b"PK\x05\x06" + bytes(18), {}, "main.xml is missing"),
    "words.txt": ("no surface\n" * 9, {}, "has no rows of numbers"),
    "mass.txt": (MATRIX, {**SIZED, "height_unit": "kg"}, 'height_unit=: kg: "kg" is the unit of a mass'),
    "size.txt": (MATRIX, {"unit": "um", "size": "40 um x 32 um x 2 um"}, "size=: .* is neither one length nor two"),
}
"""Texts that are refused, and why."""


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_right_is_refused_by_name(tmp_path, name):
    content, told, why = REFUSED[name]
    with pytest.raises(rubnoise.Refused, match=why) as refused:
        rubnoise.Surface.read(kept(tmp_path, name, content), **told)
    assert name in str(refused.value) or why[:4] in ("size", "heig")
    assert "physical_sizes" not in str(refused.value)


def test_the_command_takes_the_same_words(tmp_path):
    """With the options of a matrix, turned: the map slides along its second index; a missing option is named."""
    path = kept(tmp_path, "matrix.txt", MATRIX)
    told = ("--unit", "um", "--size", "40 um x 32 um", "--turn")
    answer = call("surface", str(path), *told, "--cutoff", "5 um", "--load", "40 mN", "--hardness", "1 GPa", "--json")
    assert answer.values()["track"]["points"] == [32, 40]
    assert "turned to slide along its second index" in answer.out
    found = rubnoise.Surface.read(path, unit="um", size=("40 um", "32 um"), turn=True, form="none")
    assert np.abs(found.heights - Z.T).max() < 2e-5
    bare = call("surface", str(path), "--unit", "um")
    assert (bare.code, bare.out) == (2, "")
    assert '--size "128 um x 128 um"' in bare.err
