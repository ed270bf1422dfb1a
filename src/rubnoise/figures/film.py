"""Films in files: a gif by pillow, an mp4 by ffmpeg."""

import shutil
import subprocess
from collections.abc import Callable, Iterable, Iterator
from contextlib import closing
from itertools import chain, pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Final, Literal

from rubnoise.errors import Refused, RubnoiseError
from rubnoise.figures.animation import Film, Frame
from rubnoise.figures.style import house_style

if TYPE_CHECKING:
    from PIL.Image import Image

Kind = Literal["gif", "mp4"]
KINDS: Final[tuple[Kind, ...]] = ("gif", "mp4")
COLOURS: Final = 128
_WHITE: Final = 248
_HUNDREDTHS: Final = 100  # a gif counts time in them
Between = Callable[[], None]


def check_film(kind: Kind) -> None:
    """Raise Refused if a film of this kind cannot be made here, PicturesMissing without matplotlib."""
    house_style()
    if kind == "mp4" and shutil.which("ffmpeg") is None:
        raise Refused("an mp4 needs ffmpeg, which is not installed here; a gif needs nothing more")


def write_film(path: Path, film: Film, kind: Kind, between: Between) -> None:
    """Write a film into a file of a kind, with any name; ``between`` is called after each frame and may raise.

    A gif has the same bytes for the same film; those of an mp4 are ffmpeg's. Raises RubnoiseError if ffmpeg fails.
    """
    write = _write_gif if kind == "gif" else _write_mp4
    # The style of the house holds while frames are drawn, and must not outlive a film that is stopped.
    with closing(film.frames()) as frames:
        write(path, film, _watched(frames, between))


def _watched(frames: Iterator[Frame], between: Between) -> Iterator[Frame]:
    for frame in frames:
        yield frame
        between()


def _write_gif(path: Path, film: Film, frames: Iterator[Frame]) -> None:
    """Write a gif that repeats for ever; colours are those of the first frame and of a bar of all shades."""
    from PIL import Image

    first = Image.fromarray(next(frames))
    palette = _palette(film, first)
    pictures = chain([first], map(Image.fromarray, frames))
    images = (each.quantize(palette=palette, dither=Image.Dither.NONE) for each in pictures)
    beginning = next(images)
    ends = [round(_HUNDREDTHS * i / film.rate) for i in range(film.distances.size + 1)]
    durations = [10 * (stop - start) for start, stop in pairwise(ends)]
    with path.open("wb") as stream:
        beginning.save(stream, format="GIF", save_all=True, append_images=images, duration=durations, loop=0)


def _palette(film: Film, first: "Image") -> "Image":
    """Return an image with the colours of the film: those of a frame, and every shade of area."""
    from PIL import Image

    from rubnoise.figures.stage import shades

    width = film.size[0]
    bar = Image.fromarray(shades(width)[None, :, :].repeat(film.size[1] // 8, axis=0))
    both = Image.new("RGB", (width, first.height + bar.height))
    both.paste(first, (0, 0))
    both.paste(bar, (0, first.height))
    return _with_white(both.quantize(colors=COLOURS, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE))


def _with_white(palette: "Image") -> "Image":
    """Make nearly white colours white: palette colours are averages, and a slide is white."""
    colours = palette.getpalette() or []
    triples = [colours[i : i + 3] for i in range(0, len(colours), 3)]
    palette.putpalette([value for triple in triples for value in ([255] * 3 if min(triple) >= _WHITE else triple)])
    return palette


def _write_mp4(path: Path, film: Film, frames: Iterable[Frame]) -> None:
    """Send raw frames to ffmpeg; H.264 in the form that slides and browsers play."""
    width, height = film.size
    source = ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", str(film.rate), "-i", "-"]
    target = ["-an", "-c:v", "libx264", "-pix_fmt", "yuv420p", "-crf", "18", "-movflags", "+faststart", "-f", "mp4"]
    command = ["ffmpeg", "-y", "-loglevel", "error", *source, *target, str(path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as ffmpeg:  # noqa: S603  (no shell)
        try:
            _feed(ffmpeg, frames)
        except BaseException:
            ffmpeg.kill()
            raise
        said = ffmpeg.stderr.read().decode(errors="replace").strip() if ffmpeg.stderr else ""
    if ffmpeg.returncode:
        raise RubnoiseError(f"ffmpeg failed: {said.splitlines()[-1] if said else ffmpeg.returncode}")


def _feed(ffmpeg: "subprocess.Popen[bytes]", frames: Iterable[Frame]) -> None:
    if ffmpeg.stdin is None:
        return
    try:
        for frame in frames:
            ffmpeg.stdin.write(frame.tobytes())
        ffmpeg.stdin.close()
    except BrokenPipeError:
        return  # ffmpeg has left, and says why itself
