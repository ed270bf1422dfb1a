"""TOML that does not parse: each broken line is named, with advice for the usual slips, and the rest is still read."""

import re
import tomllib
from dataclasses import dataclass
from typing import Any

from rubnoise.scenario import limits
from rubnoise.scenario.locate import Spans, last_key
from rubnoise.scenario.problems import Path

_POSITION = re.compile(r"(.*?) \(at (?:line (\d+), column (\d+)|end of document)\)$", re.DOTALL)
_AT_END = "(at end of document)"
_KEY = re.compile(r"[ \t]*\[.*|[^#=]+=")
_COMMA_NUMBER = re.compile(r"=\s*([+-]?[0-9]+),([0-9]+)\s*([^\s#\"']*)")
_BARE_QUANTITY = re.compile(
    r"=\s*(?!0[xob])([+-]?[0-9][0-9.+-]*(?:[eE][+-]?[0-9]+)?)\s*([A-Za-z\u00b5\u03bc%][^=#\"']*?)\s*(?:#.*)?$"
)
_BARE_WORD = re.compile(r"=\s*([A-Za-z][A-Za-z-]*)\s*(?:#.*)?$")
# A part of a dotted key: possessive, so that no text makes the search go back.
_PART = r"""(?:[A-Za-z0-9_-]++|"(?:[^"\\\n]|\\[^\n])*+"|'[^'\n]*+')"""
_TOKENS = re.compile(
    rf"""
      \#[^\n]*+
    | \"{{3}}(?:[^"\\]|\\.|"{{1,2}}(?!"))*+"{{3,5}} | '{{3}}(?:[^']|'{{1,2}}(?!'))*+'{{3,5}}
    | (?P<long>{_PART}(?:[ \t]*+\.[ \t]*+{_PART}){{{limits.KEY_DOTS + 1},}})
    | {_PART}
    | (?P<broken>["'])
    """,
    re.DOTALL | re.VERBOSE,
)
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
    long_lines = f"a line of more than {limits.LINE_CHARACTERS} characters"
    too_much = [
        Fault(line=number, message=long_lines)
        for number, line in enumerate(lines, 1)
        if len(line) > limits.LINE_CHARACTERS
    ] or _long_keys("\n".join(lines))
    if too_much:
        return Parsed(data={}, lines=[], faults=tuple(too_much[: limits.SYNTAX_ERRORS]))
    return _parse_leaving_out(list(lines))


def _long_keys(text: str) -> list[Fault]:
    """Return the keys of too many parts, in a key's own tokens: a part in quotation marks may hold anything.

    The search ends at a quotation mark that begins no string; the parser does not come further either.
    """
    found: list[Fault] = []
    for token in _TOKENS.finditer(text):
        if token["broken"]:
            break
        if token["long"]:
            line = text.count("\n", 0, token.start()) + 1
            found.append(Fault(line=line, message=f"a key of more than {limits.KEY_DOTS + 1} parts"))
    return found


def _parse_leaving_out(lines: list[str]) -> Parsed:
    faults: list[Fault] = []
    characters = 0
    while len(faults) < limits.SYNTAX_ERRORS and characters < limits.SYNTAX_CHARACTERS:
        text = "\n".join(lines)
        characters += len(text)
        if faults and (long := _long_keys(text)):  # a line left out may have begun a string that they stood in
            return Parsed(data={}, lines=[], faults=(*faults, *long)[: limits.SYNTAX_ERRORS])
        try:
            return Parsed(data=tomllib.loads(text), lines=lines, faults=tuple(faults))
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
    path, spans = last_key("\n".join([*lines[: line - 1], key[0]])) if key else ((), Spans())
    if reason.startswith(_DUPLICATES):
        return _duplicate(path, line, lines, spans)
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


def _duplicate(path: Path, line: int, lines: list[str], spans: Spans) -> Fault:
    here = re.match(r"[ \t]*([^=]*[^= \t])", lines[line - 1])
    before = "\n".join(lines[: line - 1])
    first = spans.keys.get(path)
    hint = "keep one"
    if first is not None and first.end <= len(before):
        hint = f"first given in line {before.count(chr(10), 0, first.start) + 1}; keep one of the two"
    start, end = here.span(1) if here else (0, 1)
    return Fault(line=line, start=start, end=end, path=path, message="given twice", hint=hint)
