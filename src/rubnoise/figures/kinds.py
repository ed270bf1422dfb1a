"""The names of pictures of a run and of their styles, for an editor to complete and a type checker to check."""

from typing import Literal

Kind = Literal[
    "trace",
    "lives",
    "histogram",
    "psd",
    "acf",
    "count",
    "slider",
    "phase",
    "landmarks",
    "lifelines",
    "overview",
    "sizes",
    "life_distances",
    "gaps",
    "contact",
    "load",
]
"""The names of pictures of a run."""

Style = Literal["screen", "paper", "slides"]
"""Where a picture is shown: letters and lines are small on paper and large on slides."""
