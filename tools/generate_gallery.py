"""Write docs/gallery.md and its pictures: `.venv/bin/python tools/generate_gallery.py`, after `tools/dev.py sync`.

Every command of the page that makes a run or a new picture is called in a new folder, and the picture is kept small.
tools/gallery.toml says what is on the page. With --check nothing is drawn: the tool says whether the page is what it
would write.
"""

import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from shlex import split
from typing import Final

from paper.figures import FIGURES, Sources, paper_figure
from PIL import Image
from small_png import small

ROOT: Final = Path(__file__).resolve().parent.parent
PAGE: Final = ROOT / "docs" / "gallery.md"
PICTURES: Final = ROOT / "docs" / "pictures"
ROOMS_FILE: Final = Path(__file__).with_name("gallery.toml")


@dataclass(frozen=True, slots=True, kw_only=True)
class Shown:
    """A picture: its title, the command that makes it, what there is to see, and where it lies below docs/pictures.

    ``made`` is the file that the command writes; a figure of the paper is drawn without a command.
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


def shown(picture: Mapping[str, str]) -> Shown:
    """Return a picture as tools/gallery.toml has it; that of `rubnoise plot` is called after what is drawn."""
    if "plot" not in picture:
        return Shown(**picture)
    name = picture.get("name", picture["plot"].split()[1])
    return Shown(
        title=picture["title"],
        command=f"rubnoise plot {picture['plot']} -o {name}.png",
        says=picture["says"],
        kept=f"gallery/{name}.png",
        made=f"{name}.png",
    )


def of_the_paper() -> Iterator[Shown]:
    """Yield the figures of the paper."""
    for name, figure in FIGURES.items():
        yield Shown(
            title=f"Figure {name.removeprefix('fig')}: {figure['title'][0].lower()}{figure['title'][1:]}",
            command=f"python tools/paper {name} -o figures --format png",
            says=" ".join(figure["caption"].split()),
            kept=f"paper/{name}.png",
        )


def rooms() -> Iterator[Room]:
    """Yield the parts of the page."""
    for room in tomllib.loads(ROOMS_FILE.read_text(encoding="utf-8"))["room"]:
        pictures = of_the_paper() if room.get("paper") else map(shown, room["picture"])
        yield Room(
            title=room["title"],
            begins=room["begins"],
            before=tuple(room.get("before", ())),
            pictures=tuple(pictures),
        )


ROOMS: Final = tuple(rooms())


def page() -> Iterator[str]:
    """Yield the lines of the page."""
    yield "# Gallery"
    yield ""
    yield "Pictures that rubnoise draws, each with its command. Blue and black are simulated, orange is exact theory."
    yield "`tools/generate_gallery.py` wrote this page."
    for room in ROOMS:
        yield from ("", f"## {room.title}", "", room.begins)
        if room.before:
            yield from ("", "```text", *room.before, "```")
        for each in room.pictures:
            alternative = each.title.partition(":")[0]
            yield from ("", f"### {each.title}", "", f"![{alternative}](pictures/{each.kept})", "", each.says)
            if each.made:
                yield from ("", "```text", each.command, "```")


def draw(folder: Path, pictures: Path) -> None:
    """Call the commands in a folder, and keep their pictures in another."""
    (folder / "scenarios").symlink_to(ROOT / "scenarios")
    (pictures / "paper").mkdir(parents=True, exist_ok=True)
    for name in FIGURES:
        (pictures / "paper" / f"{name}.png").write_bytes(small(paper_figure(name, ("png",), Sources())["png"]))
    for room in ROOMS:
        for command in room.before:
            call(folder, command)
        for each in room.pictures:
            if each.made:
                call(folder, each.command)
                place = pictures / each.kept
                place.parent.mkdir(parents=True, exist_ok=True)
                place.write_bytes(kept(folder / each.made))


def call(folder: Path, command: str) -> None:
    """Call a command in a folder; raises CalledProcessError where it fails."""
    print(command, file=sys.stderr)
    _, *words = split(command)
    subprocess.run([sys.executable, "-m", "rubnoise", *words], cwd=folder, stdout=subprocess.DEVNULL, check=True)


def kept(path: Path) -> bytes:
    """Return a picture as the gallery has it."""
    with Image.open(path) as picture:
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
