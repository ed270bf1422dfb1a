"""Load a scenario from a file, from those that come with rubnoise, or from a Scenario."""

import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeVar

from rubnoise.api.keywords import LARGEST, SMALLEST, shown
from rubnoise.arrays import check_unit
from rubnoise.errors import NoColumn, Refused, ScenarioRefused, refusing_files
from rubnoise.regular_file import is_hdf5
from rubnoise.scenario import Scenario
from rubnoise.scenario import build as build_scenario
from rubnoise.scenario import load as load_file
from rubnoise.scenario.fields import MOST
from rubnoise.scenario.layers import named, override_value, shipped_names
from rubnoise.scenario.reading import in_full
from rubnoise.scenario.sweep import Sweep
from rubnoise.scenario.sweep import load_sweep as load_sweep_file
from rubnoise.units import LENGTH, unit_or_one

Loaded = TypeVar("Loaded", bound=Scenario | Sweep)


def load(source: str | os.PathLike[str] | Scenario, overrides: Sequence[str] = ()) -> Scenario:
    """Read a scenario: from a TOML file, or one that comes with rubnoise by its name, such as "paper/fig5".

    A file that exists wins over a name. ``overrides`` are texts such as "run.seed=7", on top of the file. A Scenario
    comes back as it is. Raises ScenarioRefused with every problem of the file, each with its line.

    >>> import rubnoise
    >>> rubnoise.load("paper/fig5", ["run.seed=7"]).run.seed
    7
    """
    if not isinstance(source, Scenario):
        return read_by(load_file, source, _listed(overrides))
    parted = (each.partition("=") for each in in_full(_listed(overrides)))
    return source.replace({key.strip(): override_value(value) for key, _, value in parted}) if overrides else source


def read_by(reader: Callable[..., Loaded], source: str | os.PathLike[str] | Sweep, overrides: Sequence[str]) -> Loaded:
    """Read a file, or one that comes with rubnoise by its name, by a reader of scenarios, of sweeps or of either."""
    path = named(_path(source))
    if is_hdf5(path):
        ways = f'rubnoise.open("{path}") and rubnoise info {path} say what is in it'
        raise ScenarioRefused(f"{path}: is a result, not a scenario; {ways}")
    return reader(path, in_full(overrides), sizes_of)


def _listed(overrides: Any) -> Sequence[str]:
    if isinstance(overrides, str) or not all(isinstance(each, str) and "=" in each for each in overrides):
        raise Refused(f'overrides: {shown(overrides):.40}: a list of texts is needed, such as ["run.seed=7"]')
    return overrides


def load_sweep(source: str | os.PathLike[str], overrides: Sequence[str] = ()) -> Sweep:
    """Read a file with a table `[sweep]`, or one that comes with rubnoise by its name, such as "paper/fig9".

    Raises ScenarioRefused with every problem of every point, each with its line, and for a file that is no sweep.

    >>> import rubnoise
    >>> sweep = rubnoise.load_sweep("paper/fig9")
    >>> sweep.keys, len(rubnoise.expand(sweep))
    (('interface.mean_junction_count',), 5)
    """
    return read_by(load_sweep_file, source, _listed(overrides))


def _path(source: Any) -> str | os.PathLike[str]:
    if not isinstance(source, str | os.PathLike):
        form = "rubnoise.build(...) makes a scenario of values, sweep(..., grid=...) a sweep of a scenario"
        raise Refused(f"{' '.join(shown(source).split())}: is neither a file nor a name; {form}")
    return source


def example(name: str) -> Scenario:
    """Return a scenario of rubnoise's own, such as "paper/fig5"; raises Refused, with near names, for another.

    >>> import rubnoise
    >>> rubnoise.example("paper/fig5").title
    'Figure 5: excitation force and vibration'
    """
    from rubnoise.scenario.layers import shipped

    return load_file(shipped(os.fspath(_path(name))))


def build(values: Mapping[str, Any], name: str = "<python>") -> Scenario:
    """Return the scenario of values as a TOML file would give them, where a bare number is in working units.

    Working units are um, um^2, um/s, kg, MPa, N/m and N s/m. Raises ScenarioRefused with every problem.

    >>> import rubnoise
    >>> interface = {"mean_real_contact_area": "200 um^2", "mean_junction_count": 20}
    >>> rubnoise.build({"format": 1, "interface": interface, "sliding": {"distance": 1000.0}}).sliding.distance
    1000.0
    """
    if not isinstance(values, Mapping):
        raise Refused(
            f"{values!r:.40}: keys and values are needed, as a TOML file has them; rubnoise.load reads a file"
        )
    return build_scenario(values, name, sizes_of)


def sizes_of(path: str, column: str | None) -> Sequence[float]:
    """Return the diameters of a column of a file, whose unit is um if it names none; raises Refused, with the line.

    A column is a name or a number from 1 on, of HDF5 the path of a dataset; a table of one column needs none.
    """
    from rubnoise.storage.foreign import opened
    from rubnoise.storage.measured import check_values, column_of

    inside = is_hdf5(path)
    if inside and not column:
        raise NoColumn(f'{path}: which dataset? column = "/junctions/diameter" names one')
    with refusing_files(path):
        source = opened(f"{path}:{column}" if inside else path)
    several = not inside and (column is not None or len(source.heads) > 1)
    number = column_of(source, column or "", "column") if several else 0
    head, values = source.heads[number], source.arrays[number]
    check_unit(head.unit, f"{source.where}: {head.name}")
    if head.unit and unit_or_one(head.unit).dimension != LENGTH.dimension:
        raise Refused(f"{source.where}: {head.name}: has the unit {head.unit}; diameters are lengths")
    if values.size > MOST:
        raise Refused(f"{path}: has more than {MOST:,} values, which a result keeps at most; take fewer of it")
    check_values(source, number)
    wrong = (values * head.size < SMALLEST) | (values * head.size > LARGEST)
    if wrong.any():
        row = int(wrong.argmax())
        why = "must be above 0" if values[row] <= 0.0 else f"possible: {SMALLEST:g} to {LARGEST:g} um"
        raise Refused(f"{path}: {source.place(row)}: {head.name} is {values[row]:g}; {why}")
    return tuple((values * head.size).tolist())


def examples() -> tuple[str, ...]:
    """Return the names of the scenarios and sweeps that come with rubnoise, for `load`, `example` and `sweep`."""
    return shipped_names()
