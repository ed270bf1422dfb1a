"""`python -m rubnoise` is the command line, and `rubnoise` comes here too."""

import os
import signal
import sys


def main() -> None:
    """Load the command line and run it; an interrupt ends the process silently, unless a command looks out for it.

    Python's own way, an exception at any place, gets lost in libraries that are being loaded.
    """
    _open_missing_streams()
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    # typer may load pydantic, which would look for plug-ins in every installed package.
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    for library in ("OMP", "OPENBLAS", "MKL"):  # of matrices as small as ours, further threads only burn time waiting
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    from rubnoise.cli.app import main as command_line

    command_line()


def _open_missing_streams() -> None:
    """Open the null device for each closed standard stream, so that no file of ours gets its number."""
    for number, (name, mode) in enumerate({"stdin": "r", "stdout": "w", "stderr": "w"}.items()):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # gets the lowest number that is free, which is this one
            setattr(sys, name, os.fdopen(number, mode))


if __name__ == "__main__":
    main()
