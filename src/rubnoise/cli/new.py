"""`rubnoise new`, `rubnoise examples` and `rubnoise schema`: scenario files to begin with, and their JSON schema."""

import json
import os
from pathlib import Path
from typing import Annotated

from rubnoise.cli.layout import sentence
from rubnoise.cli.options import argument, option
from rubnoise.errors import OutputRefused


def shipped_scenarios(incomplete: str) -> list[str]:
    """Return the shipped scenarios whose names begin with a text, for completion in shells."""
    from rubnoise.scenario.shipped import shipped_names

    return [name for name in shipped_names() if name.startswith(incomplete)]


def command(
    file: Annotated[Path, argument("NAME.toml", "The scenario file to make, which must not exist; - prints it.")],
    *,
    source: Annotated[
        str | None,
        option(
            "EXAMPLE",
            "Copy this scenario of rubnoise's, such as paper/fig5; `rubnoise examples` lists them.",
            "--from",
            autocompletion=shipped_scenarios,
        ),
    ] = None,
) -> None:
    """Make a scenario file with every key, each explained.

    Optional keys are comments.

    It runs as it is. With --from it is a copy of a scenario that comes with rubnoise. An existing file is never
    replaced.

    Example: rubnoise new contact.toml
    """
    from rubnoise.scenario.written import copy_of, template
    from rubnoise.storage.output import whole_file

    text = template() if source is None else copy_of(source)
    if str(file) == "-":
        print(text, end="")
        return
    if os.path.lexists(file):
        raise OutputRefused(f"{file}: exists already; choose another name")
    with whole_file(file, force=False) as part:
        part.write_text(text, encoding="utf-8", newline="\n")
    print(sentence(f"{file}: written; `rubnoise check {file}` says what it means, `rubnoise run {file}` runs it"))


def print_examples() -> None:
    """List the scenarios that come with rubnoise.

    Commands take their names where they take a scenario file.

    Example: rubnoise examples
    """
    from rubnoise.scenario.shipped import shipped_titles

    titles = shipped_titles()
    width = max(map(len, titles), default=0)
    for name in sorted(titles, key=lambda each: not each.startswith("first/")):
        print(f"{name:<{width}}  {titles[name]}".rstrip())


def print_schema() -> None:
    """Print the JSON schema of scenario files, for editors that check and complete TOML.

    Example: rubnoise schema > scenarios/scenario.schema.json
    """
    from rubnoise.scenario import json_schema

    print(json.dumps(json_schema(), indent=2, ensure_ascii=False))
