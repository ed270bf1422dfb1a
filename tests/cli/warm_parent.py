"""A process that has loaded the program, and is it as often as somebody asks: `warm_parent.py DESCRIPTOR`.

Each request on the socket brings words, folder and variables, and the descriptors of three streams and of a pipe; the
answer is the number of a copy of this process, which then is Python with these words. How it ends goes down the pipe.
"""

import atexit
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
from typing import NoReturn

LENGTH_BYTES = 8
STREAMS = 3


def load() -> None:
    """Load every module of the program, and the machine code that a run needs."""
    import rubnoise

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
    gc.collect()
    gc.freeze()


def serve(channel: socket.socket) -> None:
    """Answer requests until the other end is gone."""
    ended, wake = os.pipe()
    for descriptor in (ended, wake):
        os.set_blocking(descriptor, False)
    signal.set_wakeup_fd(wake, warn_on_full_buffer=False)
    signal.signal(signal.SIGCHLD, lambda *_: None)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    living: dict[int, int] = {}
    while True:
        ready, _, _ = select.select([channel, ended], [], [])
        if ended in ready:
            with suppress(BlockingIOError):
                os.read(ended, 4096)
            _tell(living)
        if channel in ready:
            start, descriptors, _, _ = socket.recv_fds(channel, LENGTH_BYTES, STREAMS + 1)
            if not start:
                return
            content = _received(channel, int.from_bytes(start, "big"))
            child = os.fork()
            if child == 0:
                for other in (channel.detach(), ended, wake, *living.values(), descriptors.pop()):
                    os.close(other)
                _be_python(json.loads(content), descriptors)
            *streams, living[child] = descriptors
            for stream in streams:
                os.close(stream)
            channel.sendall(child.to_bytes(LENGTH_BYTES, "big"))


def _tell(living: dict[int, int]) -> None:
    """Say of every copy that has ended how it did."""
    with suppress(ChildProcessError):
        while (ended := os.waitpid(-1, os.WNOHANG))[0]:
            pipe = living.pop(ended[0])
            with suppress(BrokenPipeError):
                os.write(pipe, str(ended[1]).encode())
            os.close(pipe)


def _received(channel: socket.socket, count: int) -> bytes:
    content = b""
    while len(content) < count:
        content += channel.recv(count - len(content))
    return content


def _be_python(request: dict, streams: list[int]) -> NoReturn:
    """Be what Python with these words would be, which are `-m rubnoise ...` or `-c PROGRAM ...`."""
    code = 120  # what Python leaves with where it cannot write to its streams
    try:
        signal.set_wakeup_fd(-1)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        signal.signal(signal.SIGINT, signal.default_int_handler)
        _take(streams)
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


def _take(streams: list[int]) -> None:
    """Put streams in place of the standard ones."""
    for number, stream in enumerate(streams):
        os.dup2(stream, number)
        os.close(stream)
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
