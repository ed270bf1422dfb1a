"""Play the run of a file again from its seed, and compare every row with the file, bit for bit.

The batch engine writes into a sink that keeps nothing, so memory does not grow with the run.
"""

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Final

import numpy as np

from rubnoise.analysis.reading import Ahead
from rubnoise.analysis.verifying.findings import Check, Notes
from rubnoise.arrays import Doubles, Integers
from rubnoise.errors import RubnoiseError
from rubnoise.record.reader import Reader, Rows
from rubnoise.record.rows import JunctionState
from rubnoise.record.sink import Columns, Sink, Tee
from rubnoise.scenario import Scenario
from rubnoise.simulation.batch import Ended
from rubnoise.simulation.run import simulate
from rubnoise.storage.schema import INTERVENTION

NOT_PLAYED: Final = frozenset(("life_curve", "life_table"))
"""Groups of which no row comes from the play."""


class _BeyondFile(Exception):  # noqa: N818  (the file is wrong, not the program)
    """Raised at the first row that a file does not have."""


class Compared:
    """A sink that compares the rows of a run with those of a file, in one check for each group."""

    def __init__(self, rows: Rows) -> None:
        """Start before the first row."""
        self._rows = Ahead(rows)
        self.notes = {group: Notes(group) for group in rows.columns if group not in NOT_PLAYED}
        self.written = dict.fromkeys(self.notes, 0)

    def write(self, group: str, first_row: int, columns: Columns) -> None:
        """Compare rows of a group (see Sink)."""
        notes, total = self.notes[group], self._rows.rows(group)
        end = first_row + next(iter(columns.values())).size
        for name, values in columns.items():
            found = self._rows.column(group, name, first_row, min(end, total))
            notes.equal(f"/{group}/{name}", first_row, found, values[: found.size])
        if end > total:
            notes.say(f"/{group} rows", found=total, expected="more")
            raise _BeyondFile
        self.written[group] = end

    def count(self, group: str, expected: object) -> None:
        """Compare the number of rows of a group."""
        self.notes[group].say(f"/{group} rows", found=self._rows.rows(group), expected=expected)


def replay_checks(scenario: Scenario, run: Reader, tally: Sink) -> list[Check]:
    """Check that each group has exactly the rows that the scenario gives; ``tally`` gets the rows, too.

    Rows are made up to the first one that the file does not have. If an intervention ended lives, births come from the
    seed and these ends from the file.
    """
    compared, model = Compared(run), scenario.model()
    with suppress(_BeyondFile), _naming(compared, "slider" if model.slider else "trace"):
        scenario.check_size()
        intervened = INTERVENTION in run.provenance and not model.is_two_way
        ended = ended_of(run) if intervened else None
        simulate(model, scenario.run.seed, Tee((compared, tally)), engine="batch", ended=ended)
        for group, written in compared.written.items():
            compared.count(group, written)
    return _checks(compared)


def ended_of(rows: Rows) -> Ended:
    """Return a function for the places (um) at which a file ended junctions early, never before run and life begin."""

    def ended(number: Integers) -> Doubles:
        if not number.size:
            return np.empty(0)
        first, end = int(number[0]), int(number[-1]) + 1
        state, birth, death = (
            rows.column("junctions", name, first, end) for name in ("state", "birth_distance", "death_distance")
        )
        begin, found = np.fmax(birth, 0.0), np.full(end - first, np.inf)
        early = (state & JunctionState.ENDED_EARLY) != 0
        found[: death.size] = np.where(early, np.where(death > begin, death, begin), np.inf)
        return found[number - first]

    return ended


@contextmanager
def _naming(compared: Compared, group: str) -> Iterator[None]:
    """Note in a group the reason, if the scenario cannot be run."""
    try:
        yield
    except (RubnoiseError, ArithmeticError) as problem:
        compared.count(group, str(problem).partition("\n")[0])


def _checks(compared: Compared) -> list[Check]:
    return [notes.check() for notes in compared.notes.values()]
