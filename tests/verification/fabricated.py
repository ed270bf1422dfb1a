"""Records made by hand, right or wrong on purpose, with the face of a result file."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rubnoise.contact.overlap import junction_area
from rubnoise.model import Model
from rubnoise.record.memory import MemoryRecord
from rubnoise.record.rows import JunctionState

Doubles = NDArray[np.float64]
Groups = Mapping[str, Mapping[str, NDArray[Any]]]


@dataclass(frozen=True)
class Held:
    """Columns in memory, read as a file's are."""

    groups: Groups
    columns: dict[str, Sequence[str]] = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "columns", {name: tuple(group) for name, group in self.groups.items()})

    def rows(self, group: str) -> int:
        return int(next(iter(self.groups[group].values())).size)

    def column(self, group: str, name: str, start: int = 0, stop: int | None = None) -> NDArray[Any]:
        return self.groups[group][name][start:stop]


def held(record: MemoryRecord) -> Held:
    """Return a run in memory with the face of a file."""
    return Held(record.groups)


@dataclass(frozen=True, kw_only=True)
class Made:
    """How a record is made: everything but what is changed is as in the model.

    ``area`` is that of a life, of the distance since birth and the diameter; ``lives`` its length in diameters, and
    ``told`` what its row says of it; ``births`` the factor on the birth rate; ``together`` how many are born at a
    time, as many in all; ``always`` a count that never changes.
    """

    area: Callable[[Doubles, Doubles], Doubles] = junction_area
    lives: float = 2.0
    told: float = 2.0
    births: float = 1.0
    empty: bool = False
    together: int = 1
    always: int | None = None


def made(model: Model, seed: int, how: Made | None = None) -> Held:
    """Return a record of a contact of one diameter."""
    how = Made() if how is None else how
    generator = np.random.default_rng(seed)
    diameter, life = model.calibrated_diameter, how.lives * model.calibrated_diameter
    if how.always is not None:
        birth = _relay(generator, model.distance, life, how.always)
    else:
        first = 0.0 if how.empty else -life
        count = generator.poisson(how.births * model.birth_rate * (model.distance - first) / how.together)
        birth = np.repeat(np.sort(generator.uniform(first, model.distance, count)), how.together)
    columns = _rows(birth, diameter, how.told)
    return Held(
        {"junctions": columns, "trace": _trace(model, birth, life, lambda age: how.area(age, np.full(1, diameter)))}
    )


def _relay(generator: np.random.Generator, distance: float, life: float, count: int) -> Doubles:
    """Return births of which each follows a death at once: always as many alive."""
    phases = generator.uniform(0.0, life, count)
    births = np.sort((phases - life + life * np.arange(int(distance / life) + 2)[:, None]).ravel())
    return births[births <= distance]


def _rows(birth: Doubles, diameter: float, told: float) -> dict[str, NDArray[Any]]:
    state = np.where(birth < 0.0, np.uint8(JunctionState.ALIVE_AT_START), np.uint8(0))
    life = np.full(birth.size, told * diameter)
    return {
        "birth_distance": birth,
        "death_distance": birth + life,
        "life_distance": life,
        "diameter": np.full(birth.size, diameter),
        "state": state,
    }


def _trace(model: Model, birth: Doubles, life: float, area: Callable[[Doubles], Doubles]) -> dict[str, NDArray[Any]]:
    """Return the sums over the lives at every tick, lives being all equally long."""
    ticks = model.tick_count + 1
    first = np.ceil(birth / model.tick).astype(np.int64)
    total, count = np.zeros(ticks), np.zeros(ticks)
    for step in range(int(life / model.tick) + 2):
        age = (first + step) * model.tick - birth
        there = (age < life) & (first + step >= 0) & (first + step < ticks)
        total += np.bincount(first[there] + step, area(age[there]), ticks)
        count += np.bincount(first[there] + step, minlength=ticks)
    return {
        "distance": np.arange(ticks) * model.tick,
        "real_contact_area": total,
        "junction_count": count.astype(np.uint32),
    }
