"""The last changes to a part file, as one record: carried out once more they give the same file, however often.

HDF5's own bytes must not be half old and half new, but a kill can come between any two writes. So what is to change
is in the journal first.
"""

import struct
from typing import Final

from rubnoise.storage import disk
from rubnoise.storage.pages import Overlay

_HEAD: Final = struct.Struct("<QQ")
_PAGE: Final = struct.Struct("<QQ")


def packed_ending(overlay: Overlay) -> bytes:
    """Return the changes that an overlay holds, and the size of the file after them."""
    changes = list(overlay.changes())
    head = _HEAD.pack(overlay.size, len(changes))
    places = b"".join(_PAGE.pack(offset, len(data)) for offset, data in changes)
    return head + places + b"".join(data for _, data in changes)


def carry_out(descriptor: int, ending: bytes) -> None:
    """Make the changes of a record in a file and see them onto the disk."""
    size, count = _HEAD.unpack_from(ending)
    places = _HEAD.size + count * _PAGE.size
    data = memoryview(ending)[places:]
    for offset, length in _PAGE.iter_unpack(ending[_HEAD.size : places]):
        disk.write_all(descriptor, data[:length], offset)
        data = data[length:]
    disk.resize(descriptor, size)
    disk.sync(descriptor)
