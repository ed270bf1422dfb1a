"""`rubnoise new` and `rubnoise schema`: a scenario file to begin with, and the JSON schema of such files."""

import json
import os
from pathlib import Path
from typing import Annotated

import typer

from rubnoise.cli.layout import sentence
from rubnoise.errors import OutputRefused


def command(
    file: Annotated[Path, typer.Argument(help="The scenario file to make; it must not exist.", metavar="NAME.toml")],
) -> None:
    """Make a scenario file with every key of this version, each explained, the optional ones as comments.

    It runs as it is. An existing file is never replaced.

    Example: rubnoise new contact.toml
    """
    from rubnoise.scenario.template import template
    from rubnoise.storage.output import whole_file

    if os.path.lexists(file):
        raise OutputRefused(f"{file}: exists already; choose another name")
    with whole_file(file, force=False) as part:
        part.write_text(template(), encoding="utf-8", newline="\n")
    print(sentence(f"{file}: written; `rubnoise check {file}` says what it means, `rubnoise run {file}` runs it"))


def print_schema() -> None:
    """Print the JSON schema of scenario files, for editors that check and complete TOML.

    Example: rubnoise schema > scenarios/scenario.schema.json
    """
    from rubnoise.scenario import json_schema

    print(json.dumps(json_schema(), indent=2, ensure_ascii=False))
