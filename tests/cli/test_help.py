"""What the command line says about itself."""

import json
import subprocess
import sys

import pytest

import rubnoise
from rubnoise.cli.app import app
from tests.architecture.sources import ROOT
from tests.cli.terminal import call

COMMANDS = tuple(str(command.name) for command in app.registered_commands)
# Newer versions of typer load pydantic themselves when they build a command.
HEAVY = "{'numpy', 'scipy', 'numba', 'h5py', 'pint', 'simpy', 'matplotlib', 'mpmath', 'xarray', 'rubnoise.scenario'}"
LOADED = f"""
import sys
from rubnoise.cli.app import main
for command in {COMMANDS}:
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


def test_help_of_no_command_loads_anything_heavy() -> None:
    done = subprocess.run([sys.executable, "-c", LOADED], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.count("Example: rubnoise") == len(COMMANDS)
    assert done.stdout.splitlines()[-1] == "loaded:"


def test_the_version_is_told() -> None:
    answer = call("--version")
    assert (answer.code, answer.out, answer.err) == (0, f"rubnoise {rubnoise.__version__}\n", "")


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
