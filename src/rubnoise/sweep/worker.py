"""What a worker process does: it is sent functions to call until its parent hangs up."""

from multiprocessing.connection import Connection
from typing import Any

from rubnoise.errors import RubnoiseError
from rubnoise.sweep.orders import ORDERS


def serve(descriptor: int) -> None:
    """Answer every function and its arguments that come over a connection, in order, until there are no more.

    An answer is a pair: whether the call went well, and its value, or else the exception.
    """
    ORDERS.obey()
    with Connection(descriptor) as line:
        while ORDERS.stopped_by is None:
            try:
                function, arguments = line.recv()
            except EOFError:
                return
            ORDERS.busy = True
            _send(line, _called(function, arguments))
            ORDERS.busy = False


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
