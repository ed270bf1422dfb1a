"""Write docs/gallery.md and its pictures: `.venv/bin/python tools/generate_gallery.py`, after `tools/dev.py sync`.

Every command of the page that makes a run or a new picture is called in a new folder, and the picture is kept small.
With --check nothing is drawn: the tool says whether the page is what it would write.
"""

import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from shlex import split
from typing import Final

from PIL import Image
from small_png import small

from rubnoise.figures.paper import FIGURES

ROOT: Final = Path(__file__).resolve().parent.parent
PAGE: Final = ROOT / "docs" / "gallery.md"
PICTURES: Final = ROOT / "docs" / "pictures"
FRAME: Final = 10
"""The frame of the film that the page shows."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Shown:
    """A picture: its title, the command that makes it, what there is to see, and where it lies below docs/pictures.

    ``made`` is the file that the command writes; without one another tool keeps the picture.
    """

    title: str
    command: str
    says: str
    kept: str
    made: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Room:
    """A part of the page: its title, how it begins, the commands that come before, and its pictures."""

    title: str
    begins: str
    before: tuple[str, ...] = ()
    pictures: tuple[Shown, ...]


def of_run(title: str, options: str, says: str, *, name: str = "", run: str = "fig5.h5") -> Shown:
    """Return a picture of `rubnoise plot`, which is called after the run and what is drawn."""
    word = name or options.partition(" ")[0]
    command = f"rubnoise plot {run} {options} -o {word}.png"
    return Shown(title=title, command=command, says=says, kept=f"gallery/{word}.png", made=f"{word}.png")


CONTACT: Final = Room(
    title="The contact",
    begins="A run of the paper's Figure 5: twenty junctions on average, 20 mm of sliding at 1 mm/s.",
    before=("rubnoise run scenarios/paper/fig5.toml",),
    pictures=(
        of_run("Real contact area", "trace", "The area fluctuates about its exact mean. The band is its exact spread."),
        of_run(
            "Junctions and their sum",
            "lives",
            "Each junction is born (ring), grows, shrinks and dies (cross). All of them add up to the area. One life is"
            " black, above and below.",
        ),
        of_run(
            "Life-lines",
            "lifelines",
            "A bar for each life. The line cuts as many bars as junctions are alive there.",
        ),
        of_run("At a glance", "overview", "Junctions and their sum, one life, and the motion that they excite."),
        of_run("Sizes", "sizes", "Diameters of all junctions beside the law that they are drawn from."),
        of_run("Lengths of lives", "life_distances", "How far junctions slide from birth to death, beside the law."),
        of_run("Gaps", "gaps", "Distances from birth to birth: at random, they fall off exponentially."),
        of_run("Spectrogram", "spectrogram", "Spectra of short segments side by side: along a run nothing changes."),
        of_run("From above", "contact", "The junctions alive at one sliding distance, each in a place of its own."),
        of_run(
            "Live junctions",
            "count",
            "The number of live junctions follows Poisson's law.",
        ),
        Shown(
            title="One life",
            command="rubnoise junction fig5.h5 60 --plot junction.png",
            says="The area of junction 60, among its neighbours above, and as a part of the whole below.",
            kept="gallery/junction.png",
            made="junction.png",
        ),
        of_run("Distribution", "histogram", "How often each area occurs, on a linear and on a logarithmic axis."),
        of_run(
            "Autocovariance",
            "acf",
            "Correlation ends after a life, 2d. At each lag, 95 % of runs like this one lie in the band.",
        ),
        of_run(
            "Spectrum of the area",
            "psd",
            "The estimate follows what theory expects of it. Their ratio, below, stays within its errors over eight"
            " powers of ten.",
        ),
        Shown(
            title="What is exact",
            command="rubnoise theory scenarios/paper/fig5.toml --plot theory.png",
            says="Distribution, autocovariance and spectra, without a run.",
            kept="gallery/theory.png",
            made="theory.png",
        ),
        Shown(
            title="A film",
            command="rubnoise animate fig5.h5 -o film.gif --to 33 --seconds 2 --fps 10",
            says="One frame of it. Pairs of circles slide over each other; where they overlap is contact.",
            kept="gallery/film.png",
            made="film.gif",
        ),
    ),
)

SLIDER: Final = Room(
    title="The slider",
    begins="The same run. [Two-way coupling](two-way.md#figure-5-both-ways) has pictures of a slider that pushes back.",
    pictures=(
        of_run("Force and vibration", "slider", "The force, the displacement, and its spectrum with a line at 39 Hz."),
        of_run("Phase plane", "phase", "Where the slider is how often, with the ellipse of the exact spreads."),
        of_run(
            "Spectrum of the displacement",
            "psd --of displacement",
            "In Hz, with the ratio to what is expected.",
            name="psd_displacement",
        ),
        of_run("Spectrum of the velocity", "psd --of velocity", "In Hz, with the ratio.", name="psd_velocity"),
        of_run("Spectrum of the force", "psd --of force", "In Hz, with the ratio.", name="psd_force"),
    ),
)

LOAD: Final = Room(
    title="A load that weighs",
    begins="A light slider that leaves the surface and falls back on it. Of most of this there is no theory.",
    before=("rubnoise run scenarios/load/bouncing.toml -o bouncing.h5",),
    pictures=(
        of_run(
            "Flights and impacts",
            "load",
            "Load, separation and normal velocity. Flights are shaded, and rings mark impacts. The mean load is exact.",
            run="bouncing.h5",
        ),
        of_run(
            "Impact speeds and flight times",
            "landmarks",
            "How fast overlaps grow at impacts, and how long the slider was off the surface.",
            run="bouncing.h5",
        ),
        of_run(
            "Distribution of the load",
            "histogram --of load",
            "How often each load occurs. The share of the time off the surface is in the title.",
            name="histogram_load",
            run="bouncing.h5",
        ),
        of_run(
            "Spectrum of the normal velocity",
            "psd --of normal-velocity",
            "In Hz. Hops make most of it, far below the contact resonance.",
            name="psd_normal-velocity",
            run="bouncing.h5",
        ),
        of_run(
            "Spectrum of the load",
            "psd --of load",
            "In Hz. Impacts are short, so that the load has more at high frequencies.",
            name="psd_load",
            run="bouncing.h5",
        ),
    ),
)

SWEEPS: Final = Room(
    title="Sweeps",
    begins="A quantity of many runs, with 95 % intervals and the exact curve.",
    before=("rubnoise sweep scenarios/paper/fig7.toml -o spread --set 'sliding.distance=\"1 mm\"'",),
    pictures=(
        of_run(
            "Spread of the area",
            "real_contact_area_std",
            "The spread grows with the mean area, and falls with the number of junctions.",
            run="spread",
        ),
    ),
)

PAPER: Final = Room(
    title="The paper's figures",
    begins="Simulated, with the exact theory. [The paper](paper.md) compares its claims with them.",
    pictures=tuple(
        Shown(
            title=f"Figure {name.removeprefix('fig')}: {figure.title[0].lower()}{figure.title[1:]}",
            command=f"rubnoise figures {name} -o figures --format png",
            says=figure.caption,
            kept=f"paper/{name}.png",
        )
        for name, figure in FIGURES.items()
    ),
)

ROOMS: Final = (CONTACT, SLIDER, LOAD, SWEEPS, PAPER)


def page() -> Iterator[str]:
    """Yield the lines of the page."""
    yield "# Gallery"
    yield ""
    yield "These are the pictures that rubnoise draws, each with the command that makes it. Blue and black are"
    yield "simulated, orange is exact theory. `tools/generate_gallery.py` wrote this page."
    for room in ROOMS:
        yield from ("", f"## {room.title}", "", room.begins)
        if room.before:
            yield from ("", "```text", *room.before, "```")
        for shown in room.pictures:
            yield from ("", f"### {shown.title}", "", f"![{shown.title}](pictures/{shown.kept})", "", shown.says)
            yield from ("", "```text", shown.command, "```")


def draw(folder: Path, pictures: Path) -> None:
    """Call the commands in a folder, and keep their pictures in another."""
    (folder / "scenarios").symlink_to(ROOT / "scenarios")
    for room in ROOMS:
        for command in room.before:
            call(folder, command)
        for shown in room.pictures:
            if shown.made:
                call(folder, shown.command)
                place = pictures / shown.kept
                place.parent.mkdir(parents=True, exist_ok=True)
                place.write_bytes(kept(folder / shown.made))


def call(folder: Path, command: str) -> None:
    """Call a command in a folder; raises CalledProcessError where it fails."""
    print(command, file=sys.stderr)
    _, *words = split(command)
    subprocess.run([sys.executable, "-m", "rubnoise", *words], cwd=folder, stdout=subprocess.DEVNULL, check=True)


def kept(path: Path) -> bytes:
    """Return a picture, or a frame of a film, as the gallery has it."""
    with Image.open(path) as picture:
        if path.suffix == ".gif":
            picture.seek(FRAME)
        stream = BytesIO()
        picture.convert("RGB").save(stream, format="PNG")
    return small(stream.getvalue())


def main(arguments: Sequence[str]) -> int:
    """Draw everything and write the page; with --check only compare the page, and return 1 where it differs."""
    text = "\n".join(page()) + "\n"
    if "--check" in arguments:
        stale = not PAGE.exists() or PAGE.read_text(encoding="utf-8") != text
        print(f"docs/gallery.md {'is out of date' if stale else 'is up to date'}")
        return int(stale)
    with tempfile.TemporaryDirectory() as folder:
        draw(Path(folder), PICTURES)
    PAGE.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
