"""Damage to scenarios: to bytes, tokens and tables; hostile numbers, units and keys."""

import re
from collections.abc import Callable
from random import Random

WORD = re.compile(rb'"[^"\n]*"|[A-Za-z_][A-Za-z0-9_]*|[0-9.+-][0-9.eE+-]*|[^\sA-Za-z0-9]')
VALUES = (
    b'"9**9**9 um"',
    b'"1e999 um"',
    b'"1e-999 mm"',
    b'"-5 mm"',
    b'"1e30 km"',
    b'"5 mm + 3 mm"',
    b'"1 um^99"',
    b'"nan um"',
    b'"20 %%%%"',
    b'"1 ' + b"m*" * 300 + b'm"',
    b"1e308",
    b"1e-308",
    b"-1",
    b"0",
    b"nan",
    b"inf",
    b"9" * 5000,
    b"0x" + b"f" * 900,
    b"true",
    b"1979-05-27T07:32:00Z",
    b"[1, [2, [3]]]",
    b"[" * 900,
    b"{" * 900,
    b"{a = {b = {c = 1}}}",
    b'"\\u0000\\u001b[31m\\u202e"',
    b'"\xf0\x9f\x98\x80"',
    b'"""',
    b"'''",
    b'"\\',
)
LINES = (
    b"a" + b".a" * 400 + b" = 1",
    b"[" + b"a." * 400 + b"a]",
    b"[[sliding]]",
    b"[sweep]\nreplicates = 1000000000",
    b"[sweep.grid]\ninterface.mean_junction_count = [" + b"1," * 400 + b"1]\nrun.seed = [" + b"1," * 400 + b"1]",
    b'extends = "/dev/zero"',
    b'extends = "."',
    b'extends = "../../../../etc/passwd"',
    b'extends = "small.toml"',
    b"\xff\xfe",
    b"\x00",
    b"x = 1\r",
    b"# " + b"x" * 2000,
    *(b"k%d = 1" % n for n in range(3)),
)

Change = Callable[[bytes, Random], bytes]


def changed(content: bytes, random: Random) -> tuple[str, bytes]:
    """Return the name of a change, and a scenario with up to four such changes."""
    change = random.choice(CHANGES)
    for _ in range(random.choice((1, 1, 2, 4))):
        content = change(content, random)
    return change.__name__, content


def bytes_changed(content: bytes, random: Random) -> bytes:
    """Turn a bit, write a byte, or take one out."""
    place = random.randrange(len(content) + 1)
    new = random.choice((random.randbytes(1), random.randbytes(8), b"", b"\n", b'"', b"[", b"=", b"."))
    return content[:place] + new + content[place + random.choice((0, 1, len(new))) :]


def token_replaced(content: bytes, random: Random) -> bytes:
    """Put one token in the place of another."""
    found = list(WORD.finditer(content))
    if not found:
        return content
    target, source = random.choice(found), random.choice(found)
    return content[: target.start()] + source[0] + content[target.end() :]


def value_replaced(content: bytes, random: Random) -> bytes:
    """Give a key a hostile value."""
    lines = content.split(b"\n")
    keyed = [number for number, line in enumerate(lines) if b"=" in line]
    if keyed:
        number = random.choice(keyed)
        lines[number] = lines[number].partition(b"=")[0] + b"= " + random.choice(VALUES)
    return b"\n".join(lines)


def number_scaled(content: bytes, random: Random) -> bytes:
    """Change the exponent of a number."""
    found = list(re.finditer(rb"[0-9]+(?:\.[0-9]+)?", content))
    if not found:
        return content
    target = random.choice(found)
    return content[: target.end()] + b"e%d" % random.randrange(-40, 40) + content[target.end() :]


def lines_moved(content: bytes, random: Random) -> bytes:
    """Double a line, take one out, or exchange two."""
    lines = content.split(b"\n")
    first, second = random.randrange(len(lines)), random.randrange(len(lines))
    how = random.randrange(3)
    if how == 0:
        lines.insert(second, lines[first])
    elif how == 1:
        del lines[first]
    else:
        lines[first], lines[second] = lines[second], lines[first]
    return b"\n".join(lines)


def line_added(content: bytes, random: Random) -> bytes:
    """Add a hostile line."""
    lines = content.split(b"\n")
    lines.insert(random.randrange(len(lines) + 1), random.choice(LINES))
    return b"\n".join(lines)


def repeated(content: bytes, random: Random) -> bytes:
    """Repeat a piece until the file is as large as may be, or larger."""
    first = random.randrange(len(content) + 1)
    piece = content[first : first + random.choice((1, 10, 100, 1000))]
    times = random.choice((2, 100, 70_000 // max(1, len(piece))))
    return content[:first] + piece * times + content[first:]


CHANGES: tuple[Change, ...] = (
    bytes_changed,
    token_replaced,
    value_replaced,
    number_scaled,
    lines_moved,
    line_added,
    repeated,
)
