"""The scenario files that come with rubnoise: of the paper, its claims, its ancestors, and for lessons."""

from pathlib import Path

from rubnoise.errors import Refused

_PACKAGE = Path(__file__).parents[1]
_HOMES = (_PACKAGE / "shipped_scenarios", _PACKAGE.parents[1] / "scenarios")
"""Where an installed package keeps them, and where a checkout does."""


def shipped(name: str) -> Path:
    """Return the path of a scenario file that comes with rubnoise, such as ``paper/fig5.toml``.

    Raises Refused where the installation has lost it.
    """
    for home in _HOMES:
        path = home / name
        if path.is_file():
            return path
    raise Refused(f"scenarios/{name}: not found beside rubnoise in {_PACKAGE}; is the installation complete?")
