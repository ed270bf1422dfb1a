"""The measured figures of a run beside the exact ones, as a list that is shown as a table."""

from typing import TYPE_CHECKING

from rubnoise.answer import Answer, Row

if TYPE_CHECKING:
    import pandas as pd  # type: ignore[import-untyped]


class Summary(list[Row]):
    """The figures in the order of the file: ``run.summary[0].z``.

    >>> import rubnoise
    >>> with rubnoise.open("fig5.h5") as run:
    ...     first = run.summary[0]
    >>> first.name, first.z is not None and abs(first.z) < 4.0
    ('real_contact_area_mean', True)
    """

    def _answer(self) -> Answer:
        return Answer(title="measured figures", rows=tuple(self))

    def __repr__(self) -> str:
        return repr(self._answer())

    def _repr_html_(self) -> str:
        return self._answer()._repr_html_()

    def to_pandas(self) -> "pd.DataFrame":
        """Return the figures as a pandas DataFrame whose index is their name; raises ExtraMissing without pandas."""
        return self._answer().to_pandas().set_index("name")
