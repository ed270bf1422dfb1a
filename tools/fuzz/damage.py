"""Damage to the bytes of a file: bits, runs, cuts, swaps, splices, numbers; some with HDF5's checksums put right."""

import struct
from collections.abc import Callable, Iterator
from random import Random

NUMBERS = (0, 1, 2, 0x7F, 0xFF, 0xFFFF, 1 << 31, (1 << 32) - 1, 1 << 40, 10**15, 1 << 62, (1 << 63) - 1, (1 << 64) - 1)
HEADER = b"OHDR"
SUPERBLOCK_BYTES = 44
LONGEST = 64

Damage = Callable[[bytearray, bytes, Random], None]


def damaged(content: bytes, other: bytes, random: Random) -> tuple[str, bytes]:
    """Return the name of some damage, and a content that has it; ``other`` is a file to splice from."""
    damage = random.choice(DAMAGES)
    changed = bytearray(content)
    damage(changed, other, random)
    return damage.__name__, bytes(changed)


def bits(content: bytearray, _other: bytes, random: Random) -> None:
    """Turn some bits."""
    for _ in range(random.choice((1, 1, 1, 2, 8))):
        content[random.randrange(len(content))] ^= 1 << random.randrange(8)


def run_of_bytes(content: bytearray, _other: bytes, random: Random) -> None:
    """Overwrite a run with zeros, ones or noise."""
    first, count = _stretch(content, random)
    fill = random.choice((bytes(count), b"\xff" * count, random.randbytes(count)))
    content[first : first + count] = fill


def cut_short(content: bytearray, _other: bytes, random: Random) -> None:
    """Cut the end off."""
    del content[random.randrange(len(content)) :]


def longer(content: bytearray, _other: bytes, random: Random) -> None:
    """Add something at the end, or in the middle."""
    place = random.choice((len(content), random.randrange(len(content))))
    content[place:place] = random.randbytes(random.randrange(1, LONGEST))


def shorter(content: bytearray, _other: bytes, random: Random) -> None:
    """Take something out of the middle."""
    first, count = _stretch(content, random)
    del content[first : first + count]


def swapped(content: bytearray, _other: bytes, random: Random) -> None:
    """Exchange two pages or pieces."""
    count = random.choice((8, 64, 512, 4096))
    first, second = (random.randrange(max(1, len(content) - count)) for _ in range(2))
    content[first : first + count], content[second : second + count] = (
        content[second : second + count],
        content[first : first + count],
    )


def spliced(content: bytearray, other: bytes, random: Random) -> None:
    """Put a piece of another file, or of this one, in the place of one."""
    source = random.choice((bytes(content), other))
    count = random.choice((8, 64, 512, 4096))
    first = random.randrange(max(1, len(content) - count))
    begin = random.choice((first, random.randrange(max(1, len(source) - count))))
    content[first : first + count] = source[begin : begin + count]


def number(content: bytearray, _other: bytes, random: Random) -> None:
    """Write a number that programs stumble over."""
    size = random.choice((1, 2, 4, 8))
    first = random.randrange(max(1, len(content) - size))
    content[first : first + size] = _number(size, random)


def sealed_header(content: bytearray, _other: bytes, random: Random) -> None:
    """Change an object header and put its checksum right, so that HDF5 believes it."""
    headers = list(_headers(content))
    if not headers:
        return
    first, last = random.choice(headers)
    for _ in range(random.choice((1, 1, 2, 4))):
        size = random.choice((1, 2, 4, 8))
        place = random.randrange(first + 6, max(first + 7, last - size))
        if random.random() < 0.5:
            content[place] ^= 1 << random.randrange(8)
        else:
            content[place : place + size] = _number(size, random)
    content[last : last + 4] = struct.pack("<I", lookup3(bytes(content[first:last])))


def sealed_superblock(content: bytearray, _other: bytes, random: Random) -> None:
    """Change the superblock and put its checksum right."""
    size = random.choice((1, 2, 4, 8))
    place = random.randrange(8, SUPERBLOCK_BYTES - size)
    content[place : place + size] = _number(size, random)
    content[SUPERBLOCK_BYTES : SUPERBLOCK_BYTES + 4] = struct.pack("<I", lookup3(bytes(content[:SUPERBLOCK_BYTES])))


SEALED: frozenset[str] = frozenset(("sealed_header", "sealed_superblock"))
"""Forged rather than damaged: a program that corrects checksums can correct our hashes, too."""

DAMAGES: tuple[Damage, ...] = (
    *(bits,) * 4,
    run_of_bytes,
    cut_short,
    longer,
    shorter,
    swapped,
    spliced,
    number,
    *(sealed_header,) * 4,
    sealed_superblock,
)


def lookup3(data: bytes) -> int:
    """Return Bob Jenkins' lookup3 hash of some bytes, the checksum of HDF5's metadata."""
    mask = 0xFFFFFFFF
    a = b = c = (0xDEADBEEF + len(data)) & mask

    def turned(value: int, by: int) -> int:
        return ((value << by) | (value >> (32 - by))) & mask

    padded = data + bytes(-len(data) % 12)
    pieces = [struct.unpack_from("<III", padded, place) for place in range(0, len(padded), 12)]
    for x, y, z in pieces[:-1]:
        a, b, c = (a + x) & mask, (b + y) & mask, (c + z) & mask
        for by in (4, 6, 8, 16, 19, 4):
            a = (a - c) & mask ^ turned(c, by)
            c = (c + b) & mask
            a, b, c = b, c, a
    if not pieces:
        return c
    x, y, z = pieces[-1]
    a, b, c = (a + x) & mask, (b + y) & mask, (c + z) & mask
    for by in (14, 11, 25, 16, 4, 14, 24):
        c = ((c ^ b) - turned(b, by)) & mask
        a, b, c = b, c, a
    return b


def _headers(content: bytearray) -> Iterator[tuple[int, int]]:
    """Yield where each object header begins, and where its checksum stands."""
    place = content.find(HEADER)
    while place >= 0:
        flags = content[place + 5] if place + 5 < len(content) else 0
        after = place + 6 + (16 if flags & 0x20 else 0) + (4 if flags & 0x10 else 0)
        width = 1 << (flags & 3)
        last = after + width + int.from_bytes(content[after : after + width], "little")
        if last + 4 <= len(content):
            yield place, last
        place = content.find(HEADER, place + 1)


def _stretch(content: bytearray, random: Random) -> tuple[int, int]:
    count = random.randrange(1, LONGEST)
    return random.randrange(max(1, len(content) - count)), count


def _number(size: int, random: Random) -> bytes:
    return (random.choice(NUMBERS) & ((1 << 8 * size) - 1)).to_bytes(size, "little")
