"""A process that has loaded the program and makes copies of itself on request: `warm_parent.py DESCRIPTOR`.

Each request on the socket brings words, folder and variables, and the descriptors of a pipe, three streams, and what
else is passed on; the answer is the number of a copy of this process, which then is Python with these words. How it
ends goes down the pipe.
"""

import atexit
import fcntl
import gc
import json
import os
import pkgutil
import select
import signal
import socket
import sys
import threading
import warnings
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from typing import NoReturn

sys.path.insert(0, str(Path(__file__).parents[1]))

from tests import warm

MOST_DESCRIPTORS = 16


def load() -> None:
    """Load every module of the program, and the machine code that a run needs."""
    import rubnoise
    from rubnoise.lesson.page import readings

    warm.take_turns()
    for module in pkgutil.walk_packages(rubnoise.__path__, "rubnoise."):
        if not module.name.endswith("__main__"):
            import_module(module.name)
    rubnoise.simulate(
        rubnoise.build(
            {
                "format": 1,
                "interface": {"mean_real_contact_area": "200 um^2", "mean_junction_count": 20},
                "strength": {"mean": "250 MPa"},
                "sliding": {"speed": "1 mm/s", "distance": "20 um"},
                "slider": {"mass": "5 g", "stiffness": "300 N/m", "damping": "0.05 N*s/m"},
            }
        )
    )
    readings()  # which every page of lessons holds
    gc.collect()
    gc.freeze()


def serve(tests: socket.socket) -> None:
    """Answer requests, of the tests and of copies, until the tests are gone."""
    ended, wake = os.pipe()
    for descriptor in (ended, wake):
        os.set_blocking(descriptor, False)
    signal.set_wakeup_fd(wake, warn_on_full_buffer=False)
    signal.signal(signal.SIGCHLD, lambda *_: None)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    channels, living = [tests], dict[int, int]()
    while tests in channels:
        ready, _, _ = select.select([*channels, ended], [], [])
        if ended in ready:
            with suppress(BlockingIOError):
                os.read(ended, 4096)
            _tell(living)
        for channel in [each for each in channels if each in ready]:
            if (request := _request(channel)) is None:
                channels.remove(channel)
                channel.close()
                continue
            content, told, *descriptors = request
            ours, its = socket.socketpair()
            child = os.fork()
            if child == 0:
                for other in (*channels, ours):
                    other.close()
                for descriptor in (ended, wake, *living.values(), told):
                    os.close(descriptor)
                _be_python(json.loads(content), descriptors, its)
            living[child] = told
            channels.append(ours)
            its.close()
            for descriptor in descriptors:
                os.close(descriptor)
            with suppress(BrokenPipeError):  # killed since it asked
                channel.sendall(child.to_bytes(warm.LENGTH_BYTES, "big"))


def _tell(living: dict[int, int]) -> None:
    """Say of every copy that has ended how it did."""
    with suppress(ChildProcessError):
        while (ended := os.waitpid(-1, os.WNOHANG))[0]:
            pipe = living.pop(ended[0])
            with suppress(BrokenPipeError):
                os.write(pipe, str(ended[1]).encode())
            os.close(pipe)


def _request(channel: socket.socket) -> tuple[bytes, *tuple[int, ...]] | None:
    """Return a request and its descriptors; None for one that is not whole, since whoever asked is gone."""
    content, descriptors = b"", list[int]()
    with suppress(ConnectionResetError):
        start, descriptors, _, _ = socket.recv_fds(channel, warm.LENGTH_BYTES, MOST_DESCRIPTORS)
        count = int.from_bytes(start, "big")
        while len(content) < count and (piece := channel.recv(count - len(content))):
            content += piece
        if start and len(content) == count:
            return content, *descriptors
    for descriptor in descriptors:
        os.close(descriptor)
    return None


def _be_python(request: dict, descriptors: list[int], channel: socket.socket) -> NoReturn:
    """Be what Python with these words would be, which are `-m rubnoise ...` or `-c PROGRAM ...`."""
    code = 120  # what Python leaves with where it cannot write to its streams
    try:
        signal.set_wakeup_fd(-1)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        signal.signal(signal.SIGINT, signal.default_int_handler)
        if request["process_group"] >= 0:
            os.setpgid(0, request["process_group"])
        channel = _above(request["passed"], channel.detach())
        warm.CHANNELS[:] = [socket.socket(fileno=channel)]
        _take(descriptors, [0, 1, 2, *request["passed"]])
        os.chdir(request["folder"])
        os.environ.clear()
        os.environ.update(request["environment"])
        code = _called(request["words"])
        threading._shutdown()
        atexit._run_exitfuncs()
        sys.stdout.flush()
        sys.stderr.flush()
    finally:
        os._exit(code)


def _above(places: list[int], descriptor: int) -> int:
    """Return a descriptor of the same file above all places; the old one is closed."""
    moved = fcntl.fcntl(descriptor, fcntl.F_DUPFD_CLOEXEC, max(places, default=2) + 1)
    os.close(descriptor)
    return moved


def _take(descriptors: list[int], places: list[int]) -> None:
    """Put descriptors where they are looked for, and the standard streams upon the first three."""
    aside = [_above(places, descriptor) for descriptor in descriptors]
    for descriptor, place in zip(aside, places, strict=True):
        os.dup2(descriptor, place)
        os.close(descriptor)
    sys.stdin = open(0, closefd=False)  # noqa: SIM115
    sys.stdout = open(1, "w", closefd=False)  # noqa: SIM115
    sys.stderr = open(2, "w", errors="backslashreplace", closefd=False)  # noqa: SIM115
    sys.stdout.reconfigure(line_buffering=sys.stdout.isatty())
    sys.stderr.reconfigure(line_buffering=True)


def _called(words: list[str]) -> int:
    try:
        if words[0] == "-c":
            sys.argv = ["-c", *words[2:]]
            exec(compile(words[1], "<string>", "exec"), {"__name__": "__main__"})  # noqa: S102
        else:
            sys.argv = [import_module("rubnoise").__path__[0] + "/__main__.py", *words[2:]]
            import_module("rubnoise.__main__").main()
    except SystemExit as left:
        return 0 if left.code is None else left.code & 0xFF if isinstance(left.code, int) else 1
    except BaseException:  # noqa: BLE001
        sys.excepthook(*sys.exc_info())
        return 1
    return 0


if __name__ == "__main__":
    warnings.simplefilter("ignore", DeprecationWarning)  # since Python 3.12 threads of libraries count as a danger
    load()
    serve(socket.socket(fileno=int(sys.argv[1])))
