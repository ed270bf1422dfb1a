"""Small pictures for the repository: a png with a palette in place of full colours, a third of the size."""

from io import BytesIO
from typing import Final

from PIL import Image

COLOURS: Final = 256


def small(png: bytes) -> bytes:
    """Return a png with at most so many colours, which are enough for curves and their smooth edges."""
    with Image.open(BytesIO(png)) as picture:
        flat = picture.convert("RGB").quantize(COLOURS, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    stream = BytesIO()
    flat.save(stream, format="PNG", optimize=True)
    return stream.getvalue()
