"""Fixed choices of options whose wrong values are told further in, with what was probably meant; shells offer them."""

from typing import Final

ENGINES: Final = ("events", "batch")
PICTURES: Final = ("png", "pdf", "svg")


def engines() -> tuple[str, ...]:
    """Return what --engine takes."""
    return ENGINES


def pictures() -> tuple[str, ...]:
    """Return what --format takes."""
    return PICTURES
