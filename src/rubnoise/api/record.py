"""A run in memory, with the same groups and methods as a run in a file, which it can be saved into."""

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from rubnoise.api.column_group import Columns
from rubnoise.api.run import Run
from rubnoise.record.sink import Extent
from rubnoise.storage.reader import open_run

if TYPE_CHECKING:
    from rubnoise.record.reader import HashedReader
    from rubnoise.runs.making import KeptRun


class Record(Run):
    """A run kept in memory: ``record.trace["real_contact_area"]``, ``record.junction(17)``, ``record.plot("slider")``.

    Groups and columns are named as in a file.

    >>> import rubnoise
    >>> record = rubnoise.simulate("paper/fig5", seed=7)
    >>> record.scenario.run.seed, len(record.trace), record.compare().passed
    (7, 200001, True)
    """

    _reader: "KeptRun"

    def __init__(self, kept: "KeptRun") -> None:
        """Take over a run in memory."""
        super().__init__(kept)
        self.scenario = kept.scenario

    def reader(self) -> "KeptRun":
        """Return the rows and what their file would say."""
        return self._reader

    @property
    def extent(self) -> Extent:
        """The number of rows of each group."""
        return self._reader.extent

    def save(self, path: str | os.PathLike[str], *, force: bool = False) -> Run:
        """Write the run into a result file and open it: the bits are those of `rubnoise.run`.

        ``force`` allows an existing file to be replaced. Raises OutputRefused if the file may not be written.

        >>> import rubnoise
        >>> with rubnoise.simulate("paper/fig4", seed=7).save("kept.h5", force=True) as run:
        ...     run.provenance["seed"]
        7
        """
        from rubnoise.runs.making import save

        save(self._reader, path, force=force)
        return Run(open_run(path))

    @contextmanager
    def _file_of(self) -> "Iterator[HashedReader]":
        with TemporaryDirectory(prefix="rubnoise-") as folder, self.save(Path(folder) / "record.h5") as run:
            yield run.reader()  # type: ignore[misc]

    @property
    def _called(self) -> str:
        return "the run in memory"

    def _heading_and_groups(self) -> tuple[str, Mapping[str, Columns]]:
        title = self.scenario.title
        return f"a run in memory: {title}" if title else "a run in memory", self._groups
