"""Processes of the tests: copies of one that has loaded the command line (see warm_parent), and turns at compiling."""

import atexit
import fcntl
import json
import os
import select
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import Lock, RLock
from typing import Any

PARENT = Path(__file__).with_name("warm_parent.py")
LENGTH_BYTES = 8


class Warm(subprocess.Popen):
    """A Popen of the words behind `python`, `-m rubnoise ...` or `-c PROGRAM ...`, that finds everything loaded.

    Variables that are read when Python or a library starts come too late. Takes streams, text, env, pass_fds and
    process_group, nothing else.
    """

    def _execute_child(
        self, args: Any, executable: Any, preexec_fn: Any, close_fds: Any, pass_fds: Any, cwd: Any, env: Any,
        startupinfo: Any, creationflags: Any, shell: Any, p2cread: int, p2cwrite: int, c2pread: int, c2pwrite: int,
        errread: int, errwrite: int, restore_signals: Any, gid: Any, gids: Any, uid: Any, umask: Any,
        start_new_session: Any, process_group: int,
    ) -> None:  # fmt: skip
        assert not any((executable, preexec_fn, cwd, shell, start_new_session)), "no such option of a warm process"
        request = {
            "words": [*map(str, args)],
            "folder": os.getcwd(),  # noqa: PTH109
            "environment": dict(os.environ if env is None else env),
            "passed": [*pass_fds],
            "process_group": process_group,
        }
        content = json.dumps(request).encode()
        self._ending, told = os.pipe()
        streams = [place if found == -1 else found for place, found in enumerate((p2cread, c2pwrite, errwrite))]
        with ASKING:
            channel = _channel()
            socket.send_fds(channel, [len(content).to_bytes(LENGTH_BYTES, "big")], [told, *streams, *pass_fds])
            channel.sendall(content)
            answer = channel.recv(LENGTH_BYTES, socket.MSG_WAITALL)
            assert answer, "the process that is copied has ended"
            self.pid = int.from_bytes(answer, "big")
        os.close(told)
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


ASKING = Lock()
CHANNELS: list[socket.socket] = []
"""The way to ask the process that is copied, once it has been started."""


def _channel() -> socket.socket:
    """Return that way; start the process, one for all tests of this one, where there is none yet."""
    if not CHANNELS:
        ours, its = socket.socketpair()
        with its:
            parent = subprocess.Popen([sys.executable, PARENT, str(its.fileno())], pass_fds=[its.fileno()])
        atexit.register(_end, ours, parent)
        CHANNELS.append(ours)
    return CHANNELS[0]


def _end(channel: socket.socket, parent: "subprocess.Popen[bytes]") -> None:
    channel.close()
    parent.wait()


# One process at a time compiles kernels; the others wait and load its machine code from the cache.
WAITING = RLock()
DEPTH = [0]


def take_turns() -> None:
    """Make this process and its copies wait while another process that takes turns compiles."""
    from numba.core.dispatcher import Dispatcher  # which the process that distributes tests does not need

    from rubnoise.cli import terminal

    plain = Dispatcher.compile
    # Which test compiles what others then load is a matter of chance; what they print is not.
    terminal._say_compiling = lambda: None

    def compile_in_turn(dispatcher: Any, signature: Any) -> Any:
        if _kept(dispatcher, signature):
            return plain(dispatcher, signature)
        with _turn():
            return plain(dispatcher, signature)

    Dispatcher.compile = compile_in_turn


def _kept(dispatcher: Any, signature: Any) -> bool:
    """Return whether the machine code is in the cache, or there is no cache."""
    cache = dispatcher._cache
    if not hasattr(cache, "_cache_file"):
        return True
    dispatcher.targetctx.refresh()
    try:
        return cache._index_key(signature, dispatcher.targetctx.codegen()) in cache._cache_file._load_index()
    except Exception:  # noqa: BLE001  (an index that a test has damaged)
        return False


@contextmanager
def _turn() -> Iterator[None]:
    """Hold a lock on a source file; a kernel may compile other kernels while it holds it."""
    from rubnoise import compiling

    with WAITING, Path(compiling.__file__).open("rb") as file:
        if not DEPTH[0]:
            fcntl.flock(file, fcntl.LOCK_EX)
        DEPTH[0] += 1
        try:
            yield
        finally:
            DEPTH[0] -= 1
            if not DEPTH[0]:
                fcntl.flock(file, fcntl.LOCK_UN)  # a copy of this process may still have the file open
