"""What the command line says about itself."""

import json
import re
import subprocess
import sys
from typing import get_type_hints

import pytest
from rich.text import Text

import rubnoise
from rubnoise.cli import export, listen, plot
from rubnoise.cli.app import COMMANDS, program
from rubnoise.cli.commands import literal
from rubnoise.cli.figures import PICTURES
from rubnoise.cli.run import ENGINES
from rubnoise.figures.style import FORMATS
from rubnoise.scenario import json_schema
from tests.architecture.sources import ROOT
from tests.cli.terminal import call

# Newer versions of typer load pydantic themselves when they build a command.
HEAVY = "{'numpy', 'scipy', 'numba', 'h5py', 'pint', 'simpy', 'matplotlib', 'mpmath', 'xarray', 'rubnoise.scenario'}"
LOADED = f"""
import sys
from rubnoise.cli.app import main
for command in {tuple(COMMANDS)}:
    sys.argv = ["rubnoise", command, "--help"]
    try:
        main()
    except SystemExit as left:
        assert not left.code, left.code
print("loaded:", *sorted({HEAVY} & set(sys.modules)))
"""


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help_with_an_example(command: str) -> None:
    answer = call(command, "--help")
    assert (answer.code, answer.err) == (0, "")
    assert f"Example: rubnoise {command}" in answer.out


@pytest.mark.parametrize("command", COMMANDS)
def test_help_shows_its_texts_as_they_are_written(command: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "120")
    (registered,) = program([command]).registered_commands
    said = _words(call(command, "--help").out)
    hints = get_type_hints(registered.callback, include_extras=True)
    written = [about.help for hint in hints.values() for about in getattr(hint, "__metadata__", ())]
    for text in (*written, registered.callback.__doc__):
        assert _words(text) in said
    assert "<bool>" not in said
    assert "list[" not in said


def _words(text: str) -> str:
    """Return a text in one line, without the frames of help and what it adds at the end of a row."""
    plain = re.sub(r"\[(required|default: .*?)\]|[│*]", " ", text)
    return " ".join(re.sub(r"│ *│", " ", plain).split())


def test_brackets_in_help_are_no_styles(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "120")
    assert "A file with a table [sweep]. [required]" in call("sweep", "--help").out
    assert "For a file with a table [sweep], check and list every point" in call("check", "--help").out
    assert Text.from_markup(literal(r"[a] \[b] [bold]c[/] [1] [K] [")).plain == r"[a] \[b] [bold]c[/] [1] [K] ["


@pytest.mark.parametrize(
    ("command", "option", "choices"),
    [
        ("run", "--engine", ENGINES),
        ("sweep", "--engine", ENGINES),
        ("figures", "--format", PICTURES),
        ("export", "--to", tuple(export.Kind)),
        ("export", "--group", tuple(export.Group)),
        ("listen", "--what", tuple(listen.What)),
        ("listen", "--rate", tuple(listen.Rate)),
        ("plot", "WHAT", tuple(plot.What)),
    ],
)
@pytest.mark.parametrize("columns", [60, 80])
def test_an_option_with_fixed_choices_names_them_all(
    command: str, option: str, choices: tuple[str, ...], columns: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", str(columns))
    text = call(command, "--help").out
    start = re.search(rf"^│ [* ]*{option}\b", text, re.MULTILINE)
    assert start
    row = re.split(r"\n│ {1,4}-|╰", text[start.start() + 6 :])[0]
    assert set(choices) <= set(re.findall(r"\w+", row))


def test_choices_are_those_of_scenarios_and_pictures() -> None:
    engine = json_schema()["$defs"]["Run"]["properties"]["engine"]
    assert set(ENGINES) == set(engine["enum"])
    assert PICTURES == FORMATS


def test_a_choice_that_is_none_is_told_in_the_programs_own_words() -> None:
    answer = call("export", "x.h5", "--to", "xlsx")
    assert answer.code == 2
    assert "Invalid value for '--to': 'xlsx' is not one of 'csv', 'parquet'," in answer.err


def test_help_of_no_command_loads_anything_heavy() -> None:
    done = subprocess.run([sys.executable, "-c", LOADED], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("Example: rubnoise") == len(COMMANDS)
    assert done.stdout.splitlines()[-1] == "loaded:"


def test_the_version_is_told() -> None:
    answer = call("--version")
    assert (answer.code, answer.out.partition(" (")[0].strip(), answer.err) == (
        0,
        f"rubnoise {rubnoise.__version__}",
        "",
    )


def test_without_a_command_help_is_shown() -> None:
    answer = call()
    assert answer.code == 2
    assert all(command in answer.out + answer.err for command in COMMANDS)


def test_an_unknown_command_is_refused() -> None:
    answer = call("rum")
    assert (answer.code, answer.out) == (2, "")
    assert "rum" in answer.err


def test_the_schema_is_the_one_that_is_kept_with_the_scenarios() -> None:
    answer = call("schema")
    assert (answer.code, answer.err) == (0, "")
    kept = (ROOT / "scenarios" / "scenario.schema.json").read_text(encoding="utf-8")
    assert answer.out == kept
    assert "interface" in json.loads(kept)["properties"]
