"""Commands of earlier versions: each says what to call now, and ends with exit code 2."""

from typing import Any, Final

import typer

from rubnoise.errors import Refused

INSTEAD: Final = {
    "animate": "films are not drawn any more; `rubnoise page RUN.h5 --as lesson` shows junctions as they slide",
    "cite": "the entry to cite is CITATION.cff of the project; `rubnoise --version` prints the version to give with it",
    "claims": "`python tools/paper` in a clone of the project tests the claims of the paper and of its field",
    "contact": "call rubnoise.greenwood_williamson(...) in Python, which takes the same words",
    "docs": "the pages stand in the folder docs of the project, and on its site",
    "figures": "`python tools/paper -o figures` in a clone of the project draws the figures of the paper",
    "resume": "a run is not resumed any more; the `rubnoise run` that began it makes it again, with the same bits",
}
"""What to do in place of each."""

SETTINGS: Final[dict[str, Any]] = {
    "context_settings": {"allow_extra_args": True, "ignore_unknown_options": True},
}
"""How the commands are registered: whatever follows them is taken."""


def command(context: typer.Context) -> None:
    """Say what to call instead."""
    raise Refused(f"rubnoise {context.info_name}: {INSTEAD[str(context.info_name)]}")
