"""The figures of the paper by name, what they are drawn from, and their files."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Final

from paper.ledger import Tell
from rubnoise.api.running import simulate
from rubnoise.errors import Refused
from rubnoise.figures.style import FORMATS, Format, as_bytes, house_style
from rubnoise.figures.tracks import Stretch
from rubnoise.record.rows import Reader
from rubnoise.scenario import Scenario, load
from rubnoise.scenario.layers import shipped
from rubnoise.scenario.sweep import Point, expand, load_sweep
from rubnoise.storage.output import check_output, whole_file

FIGURES: Final = {
    **dict.fromkeys(("fig2", "fig3"), "junction"),
    **dict.fromkeys(("fig4", "fig5", "fig6"), "traces"),
    **dict.fromkeys(("fig7", "fig8", "fig9"), "spectra"),
}
"""The figures, and the module that draws each; docs/gallery.md has their captions."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Sources:
    """The scenarios of the figures: those of rubnoise, or those of the same names in a folder."""

    folder: Path | None = None
    tell: Tell = lambda _text: None

    def scenario(self, name: str, *changes: str) -> Scenario:
        """Return a scenario; raises ScenarioRefused."""
        return load(self._path(name), list(changes))

    def stretch(self, name: str, stop: float | None = None) -> Stretch:
        """Run a scenario, and return its run from the start to a distance in um, or all of it."""
        return Stretch.of(simulate(self.scenario(name)).reader(), 0.0, stop)

    def points(self, name: str) -> Iterator[tuple[Point, Reader]]:
        """Run a sweep, and yield its points with their runs."""
        points = expand(load_sweep(self._path(name)))
        for done, point in enumerate(points, 1):
            self.tell(f"{name}: {done} of {len(points)} runs")
            yield point, simulate(point.scenario).reader()

    def _path(self, name: str) -> Path:
        return shipped(f"paper/{name}.toml") if self.folder is None else self.folder / f"{name}.toml"


def chosen(names: Iterable[str]) -> tuple[str, ...]:
    """Return the named figures in the paper's order, all without a name; raises Refused for an unknown one."""
    wanted = tuple(names) or tuple(FIGURES)
    if wrong := [name for name in wanted if name not in FIGURES]:
        raise Refused(f"{', '.join(wrong)}: no figure of the paper; there are {', '.join(FIGURES)}")
    return tuple(name for name in FIGURES if name in wanted)


def paper_figure(name: str, formats: Iterable[Format], sources: Sources) -> dict[Format, bytes]:
    """Return a figure as the bytes of its files, which are equal at each call."""
    draw = getattr(import_module(f"paper.{FIGURES[name]}"), f"draw_{name}")
    with house_style():
        figure = draw(sources)
        # Once for all formats, so that none depends on which others are wanted.
        figure.draw_without_rendering()
        figure.set_layout_engine("none")
        return {kind: as_bytes(figure, kind) for kind in formats}


def draw(names: Iterable[str], folder: Path, formats: Iterable[Format], sources: Sources, *, force: bool) -> None:
    """Draw figures into a folder, which is made; raises Refused before any run for a name or an existing file."""
    kinds = tuple(formats) or FORMATS
    wanted = chosen(names)
    folder.mkdir(parents=True, exist_ok=True)
    for name in wanted:
        for kind in kinds:
            check_output(folder / f"{name}.{kind}", force=force)
    for name in wanted:
        for kind, content in paper_figure(name, kinds, sources).items():
            with whole_file(folder / f"{name}.{kind}", force=force) as part:
                part.write_bytes(content)
            print(folder / f"{name}.{kind}")
