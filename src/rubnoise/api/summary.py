"""The measured figures of a run beside the exact ones, as a list that is shown as a table."""

from typing import TYPE_CHECKING

from rubnoise.analysis.agreement import Agreement
from rubnoise.errors import needing
from rubnoise.tables import as_html, as_text, in_short, shortened

if TYPE_CHECKING:
    import pandas as pd  # type: ignore[import-untyped]

_HEADS = ("figure", "measured", "exact", "error", "z")


class Summary(list[Agreement]):
    """The figures in the order of the file: ``run.summary[0].z``."""

    def _rows(self) -> list[tuple[str, ...]]:
        seen = ((each.name, each.observed, each.expected, each.standard_error, each.z) for each in self)
        return [(name, *("" if value is None else in_short(value) for value in values)) for name, *values in seen]

    def __repr__(self) -> str:
        return shortened(as_text(_HEADS, self._rows(), range(1, len(_HEADS))))

    def _repr_html_(self) -> str:
        return as_html("measured figures", _HEADS, self._rows())

    def to_pandas(self) -> "pd.DataFrame":
        """Return the figures as a pandas DataFrame whose index is their name; raises ExtraMissing without pandas."""
        with needing("analysis", "to_pandas"):
            import pandas as pd
        columns = ("observed", "expected", "standard_error", "z")
        values = {column: [getattr(each, column) for each in self] for column in columns}
        return pd.DataFrame(values, index=pd.Index([each.name for each in self], name="figure"))
