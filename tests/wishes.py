"""What the command line asks of the tests; set by conftest before any of them is loaded."""


class Wishes:
    """Whether frozen values are to be written, and whether all is to be tried that there is time for."""

    freeze = False
    everything = False


def examples(few: int, many: int) -> int:
    """Return how many examples to try: few every day, many with --all."""
    return many if Wishes.everything else few
