"""`python -m rubnoise` is the command line, and `rubnoise` comes here too."""

import os
import signal


def main() -> None:
    """Load the command line and run it; an interrupt while it is being loaded ends the process without a word."""
    usual = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    if usual:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    # Plug-ins of pydantic, of which we use none, are looked for in all that is installed.
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
    from rubnoise.cli.app import main as command_line

    if usual:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    command_line()


if __name__ == "__main__":
    main()
