"""Looks at result files for a program that runs threads and should not make copies of itself.

A process of one thread, started by the first file that such a program opens (a notebook, say) and gone with it, is
handed the descriptor of each file and makes the copies in its place.
"""

import os
import socket
import sys
import threading
from contextlib import suppress
from signal import SIG_IGN, SIGINT, signal
from typing import TYPE_CHECKING, Final
from weakref import finalize

from rubnoise.storage.vetting import WALL_SECONDS, vetted

if TYPE_CHECKING:
    from subprocess import Popen

    from rubnoise.storage.looks import LookName

START_SECONDS: Final = 60.0
END_SECONDS: Final = 2.0
PROGRAM: Final = "from rubnoise.storage.attendant import attend; attend()"
CHANNEL: Final = 0
LENGTH_BYTES: Final = 8
WORDS: "Final[dict[LookName, bytes]]" = {"survey": b"?", "inventory": b"*", "inspection": b"!"}
"""What is sent along with a descriptor: which look is wanted."""


class Attendant:
    """The process that looks at files for this one, and the way to ask it."""

    def __init__(self) -> None:
        """Wait for the first file; nothing is started yet."""
        self._asking = threading.Lock()
        self._channel: socket.socket | None = None
        self._owner = 0

    def ask(self, descriptor: int, look: "LookName" = "survey") -> bytes:
        """Return what a look at an open file finds (see looks); raises OSError where no process answers."""
        with self._asking:
            if self._owner != os.getpid():  # after a fork the channel is that of the parent
                self._renew()
            try:
                return self._asked(descriptor, look)
            except ConnectionError:
                self._renew()  # somebody ended it: once more, with a new one
                return self._asked(descriptor, look)

    def _asked(self, descriptor: int, look: "LookName") -> bytes:
        channel = self._channel
        if channel is None:
            raise ConnectionError("no process looks at result files")
        socket.send_fds(channel, [WORDS[look]], [descriptor])
        return _received(channel, int.from_bytes(_received(channel, LENGTH_BYTES), "big"))

    def _renew(self) -> None:
        if self._channel is not None:
            self._channel.close()
        self._channel, process = _started()
        self._owner = os.getpid()
        finalize(self, _end, self._channel, process)


ATTENDANT: Final = Attendant()


def attend() -> None:
    """Be that process: answer until the program that asks is gone."""
    from rubnoise.storage.looks import look_of

    looks = {word: look_of(name) for name, word in WORDS.items()}
    signal(SIGINT, SIG_IGN)
    with suppress(ConnectionError), socket.socket(fileno=CHANNEL) as channel:  # it may be killed while it waits
        while True:
            word, descriptors, _, _ = socket.recv_fds(channel, 1, 1)
            if not descriptors:
                return
            answer = vetted(descriptors[0], looks[word])
            os.close(descriptors[0])
            channel.sendall(len(answer).to_bytes(LENGTH_BYTES, "big") + answer)


def _started() -> "tuple[socket.socket, Popen[bytes]]":
    """Start the process; it has our modules' folders, and the other end of the channel in place of standard input.

    No other descriptor: a lock that this program holds, on a file that it has open in HDF5, would outlive its file.
    """
    from subprocess import Popen  # which only a program with threads needs

    ours, its = socket.socketpair()
    ours.settimeout(START_SECONDS + WALL_SECONDS)
    folders = os.pathsep.join(filter(None, sys.path))
    with its:
        command = [sys.executable, "-P", "-c", PROGRAM]
        return ours, Popen(command, stdin=its.fileno(), env={**os.environ, "PYTHONPATH": folders})  # noqa: S603  (our own words)


def _end(channel: socket.socket, process: "Popen[bytes]") -> None:
    """Let the process see that nobody asks any more, and wait a moment for its end."""
    from subprocess import TimeoutExpired

    channel.close()
    with suppress(TimeoutExpired):
        process.wait(END_SECONDS)


def _received(channel: socket.socket, count: int) -> bytes:
    parts = bytearray()
    while len(parts) < count:
        part = channel.recv(min(count - len(parts), 1 << 20))
        if not part:
            raise ConnectionError("the process that looks at result files has ended")
        parts += part
    return bytes(parts)
