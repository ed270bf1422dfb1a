"""TOML that does not parse: each broken line is named, with advice for the usual slips, and the rest is still read."""

import re
import tomllib
from dataclasses import dataclass
from typing import Any

from rubnoise.scenario import limits
from rubnoise.scenario.locate import last_key, locate
from rubnoise.scenario.problems import Path

_POSITION = re.compile(r"(.*?) \(at (?:line (\d+), column (\d+)|end of document)\)$", re.DOTALL)
_AT_END = "(at end of document)"
_KEY = re.compile(r"[ \t]*\[.*|[^#=]+=")
_COMMA_NUMBER = re.compile(r"=\s*([+-]?[0-9]+),([0-9]+)\s*([^\s#\"']*)")
_BARE_QUANTITY = re.compile(r"=\s*([+-]?[0-9][0-9.eE+-]*)\s+([A-Za-z\u00b5\u03bc%][^=#\"']*?)\s*(?:#.*)?$")
_BARE_WORD = re.compile(r"=\s*([A-Za-z][A-Za-z-]*)\s*(?:#.*)?$")
_UNCLOSED = ("Illegal character '\\n'", "Unterminated string", 'Expected "\'"')
_DUPLICATES = ("Cannot overwrite a value", "Duplicate inline table key", "Cannot declare", "Cannot mutate immutable")


@dataclass(frozen=True, slots=True, kw_only=True)
class Fault:
    """What breaks the text: a line (from 1), columns (from 0), the key it is about where known, message and advice."""

    line: int
    start: int = 0
    end: int = 1
    message: str
    path: Path = ()
    hint: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Parsed:
    """The data of a text, the faults in it, and its lines with those at fault left empty."""

    data: dict[str, Any]
    lines: list[str]
    faults: tuple[Fault, ...]


def parse(lines: list[str]) -> Parsed:
    """Parse TOML, leaving out each line that breaks it, so that one report can name them all."""
    too_much = tuple(
        Fault(line=number, message=message) for number, line in enumerate(lines, 1) if (message := _too_much_on(line))
    )
    if too_much:
        return Parsed(data={}, lines=[], faults=too_much[: limits.SYNTAX_ERRORS])
    return _parse_leaving_out(list(lines))


def _too_much_on(line: str) -> str:
    if len(line) > limits.LINE_CHARACTERS:
        return f"a line of more than {limits.LINE_CHARACTERS} characters"
    key = line.partition("=")[0]
    if key.count(".") > limits.KEY_DOTS and "," not in key and not key.lstrip().startswith("#"):
        return f"a key of more than {limits.KEY_DOTS + 1} parts"
    return ""


def _parse_leaving_out(lines: list[str]) -> Parsed:
    faults: list[Fault] = []
    while len(faults) < limits.SYNTAX_ERRORS:
        try:
            return Parsed(data=tomllib.loads("\n".join(lines)), lines=lines, faults=tuple(faults))
        except tomllib.TOMLDecodeError as error:
            fault, at_end = _fault(str(error), lines), _AT_END in str(error)
        except RecursionError:
            fault, at_end = Fault(line=1, message="nested too deeply"), True
        faults.append(fault)
        broken = lines[fault.line - 1].strip()
        # Without its header the keys of a table would be blamed for being in the wrong one.
        if at_end or not broken or broken.startswith("["):
            break
        lines[fault.line - 1] = ""
    return Parsed(data={}, lines=lines, faults=tuple(faults))


def _fault(error: str, lines: list[str]) -> Fault:
    found = _POSITION.match(error)
    last = max((number for number, line in enumerate(lines, 1) if line.strip()), default=1)
    line, column = (int(found[2] or last), int(found[3] or 1)) if found else (last, 1)
    reason, line = found[1] if found else error, min(line, len(lines))
    text = lines[line - 1]
    key = _KEY.match(text)
    path = last_key("\n".join([*lines[: line - 1], key[0]])) if key else ()
    if reason.startswith(_DUPLICATES):
        return _duplicate(path, line, lines)
    return _usual_slip(path, line, text) or Fault(
        line=line,
        start=column - 1,
        end=column,
        path=path,
        message=f"not valid TOML: {reason[:1].lower()}{reason[1:]}",
        hint="is the closing quotation mark missing?" if reason.startswith(_UNCLOSED) else "",
    )


def _usual_slip(path: Path, line: int, text: str) -> Fault | None:
    if comma := _COMMA_NUMBER.search(text):
        number, unit = f"{comma[1]}.{comma[2]}", comma[3]
        hint = f'write "{number} {unit}"' if unit else f"write {number}"
        span = comma.start(1), comma.end(3) if unit else comma.end(2)
        return Fault(line=line, start=span[0], end=span[1], path=path, message="a comma in a number", hint=hint)
    if bare := _BARE_QUANTITY.search(text):
        hint = f'write "{bare[1]} {bare[2]}"'
        message = "a value with a unit needs quotation marks"
        return Fault(line=line, start=bare.start(1), end=bare.end(2), path=path, message=message, hint=hint)
    if word := _BARE_WORD.search(text):
        hint, (start, end) = f'write "{word[1]}"', word.span(1)
        return Fault(line=line, start=start, end=end, path=path, message="a text needs quotation marks", hint=hint)
    return None


def _duplicate(path: Path, line: int, lines: list[str]) -> Fault:
    here = re.match(r"[ \t]*([^=]*[^= \t])", lines[line - 1])
    before = "\n".join(lines[: line - 1])
    first = locate(before).keys.get(path)
    hint = (
        f"first given in line {before.count(chr(10), 0, first.start) + 1}; keep one of the two" if first else "keep one"
    )
    start, end = here.span(1) if here else (0, 1)
    return Fault(line=line, start=start, end=end, path=path, message="given twice", hint=hint)
