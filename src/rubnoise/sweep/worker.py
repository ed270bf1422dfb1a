"""What a worker process does: it is sent functions to call until its parent hangs up."""

import gc
import os
from multiprocessing.connection import Connection
from typing import Any, NoReturn

from rubnoise.errors import RubnoiseError
from rubnoise.sweep.orders import ORDERS


def serve(descriptor: int) -> NoReturn:
    """Answer every function and its arguments that come over a connection, in order, until there are no more; then end.

    An answer is a pair: whether the call went well, and its value, or else the exception. What the first call has
    loaded stays for good, and garbage is looked for from then on, but not there.
    """
    ORDERS.obey()
    with Connection(descriptor) as line:
        if _answer(line):
            gc.freeze()
            gc.enable()
        while _answer(line):
            pass
    os._exit(0)  # nothing is open any more, and taking all modules apart would take a third of a second


def _answer(line: "Connection[Any, Any]") -> bool:
    """Answer one call; return whether there was one, and nobody has asked to stop."""
    try:
        function, arguments = line.recv()
    except (EOFError, ConnectionResetError):  # the second where the parent was killed before it had read all answers
        return False
    ORDERS.busy = True
    _send(line, _called(function, arguments))
    ORDERS.busy = False
    return ORDERS.stopped_by is None


def _called(function: Any, arguments: tuple[Any, ...]) -> tuple[bool, Any]:
    try:
        return True, function(*arguments)
    except Exception as problem:  # noqa: BLE001  (the parent is told, whatever it is)
        return False, problem


def _send(line: "Connection[Any, Any]", answer: tuple[bool, Any]) -> None:
    """Send an answer; one that cannot be pickled goes as its text."""
    try:
        line.send(answer)
    except BrokenPipeError:
        return
    except Exception as problem:  # noqa: BLE001  (pickling calls code of any kind)
        line.send((False, RubnoiseError(f"{problem}: {answer[1]!r}")))
