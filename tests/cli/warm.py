"""The command line in processes of their own that need not load it first: copies of one that has (see warm_parent)."""

import atexit
import json
import os
import select
import socket
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

from tests.cli.warm_parent import LENGTH_BYTES

PARENT = Path(__file__).with_name("warm_parent.py")


class Warm(subprocess.Popen):
    """A Popen of the words behind `python`, `-m rubnoise ...` or `-c PROGRAM ...`, that finds everything loaded.

    Variables that are read when Python or a library starts come too late. Takes streams, text and env, nothing else.
    """

    def _execute_child(
        self, args: Any, executable: Any, preexec_fn: Any, close_fds: Any, pass_fds: Any, cwd: Any, env: Any,
        startupinfo: Any, creationflags: Any, shell: Any, p2cread: int, p2cwrite: int, c2pread: int, c2pwrite: int,
        errread: int, errwrite: int, *others: Any,
    ) -> None:  # fmt: skip
        assert not any((executable, preexec_fn, pass_fds, cwd, shell)), "a warm process has no such options"
        there = os.environ if env is None else env
        request = {"words": [*map(str, args)], "folder": os.getcwd(), "environment": dict(there)}  # noqa: PTH109
        content = json.dumps(request).encode()
        self._ending, told = os.pipe()
        streams = [place if found == -1 else found for place, found in enumerate((p2cread, c2pwrite, errwrite))]
        channel = _channel()
        socket.send_fds(channel, [len(content).to_bytes(LENGTH_BYTES, "big")], [*streams, told])
        channel.sendall(content)
        os.close(told)
        self.pid = int.from_bytes(channel.recv(LENGTH_BYTES, socket.MSG_WAITALL), "big")
        self._child_created = True
        self._close_pipe_fds(p2cread, p2cwrite, c2pread, c2pwrite, errread, errwrite)

    def _try_wait(self, wait_flags: int) -> tuple[int, int]:
        if wait_flags & os.WNOHANG and not select.select([self._ending], [], [], 0.0)[0]:
            return 0, 0
        status = int(os.read(self._ending, 16))
        os.close(self._ending)
        return self.pid, status

    def _internal_poll(self, _deadstate: Any = None, *others: Any) -> int | None:
        if self.returncode is None:
            with self._waitpid_lock:
                pid, status = self._try_wait(os.WNOHANG)
                if pid:
                    self._handle_exitstatus(status)
        return self.returncode


@cache
def _channel() -> socket.socket:
    """Start the process that is copied, one for all tests of this one, and return the way to ask it."""
    ours, its = socket.socketpair()
    with its:
        parent = subprocess.Popen([sys.executable, PARENT, str(its.fileno())], pass_fds=[its.fileno()])

    def end() -> None:
        ours.close()
        parent.wait()

    atexit.register(end)
    return ours
