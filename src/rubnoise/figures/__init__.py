"""Every picture that rubnoise draws: of a run, of a sweep, of a scenario's theory, of surfaces and of an inference.

Begin with `catalogue`, which names the pictures of a run, and `pictures`, which draws them. `tracks` reads what they
show along the run, with what theory says of it; `panes` draws it; `style` holds colours, titles and legends.
"""

from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from matplotlib.axes import Axes as Axes
    from matplotlib.figure import Figure as Figure
else:  # matplotlib, which is optional, is imported where something is drawn
    Axes = Figure = Any

OfContact = Literal["trace", "lives", "histogram", "psd", "acf", "count", "lifelines", "overview", "contact"]
OfMotion = Literal["slider", "phase", "landmarks", "load"]
OfLaws = Literal["sizes", "life_distances", "gaps"]
Kind = Literal[OfContact, OfMotion, OfLaws]
"""The names of pictures of a run, for an editor to complete and a type checker to check."""

Style = Literal["screen", "paper", "slides"]
"""Where a picture is shown: letters and lines are small on paper and large on slides."""
