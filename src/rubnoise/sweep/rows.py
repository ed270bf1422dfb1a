"""What is left of a run when it is over."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """One run that is done, as the index of its sweep has it.

    ``file`` lies relative to the folder of the sweep, and is empty where no file is kept; ``figures`` are named as in
    /summary of a run; ``arrays`` have one shape for each name in all runs of a sweep. ``of_point`` are such arrays that
    are the same for all replicates of a point; they come with the first one.
    """

    run_id: str
    file: str = ""
    figures: Mapping[str, float] = field(default_factory=dict)
    arrays: Mapping[str, NDArray[Any]] = field(default_factory=dict)
    of_point: Mapping[str, NDArray[Any]] = field(default_factory=dict)
