"""Find problems of keys: unknown, missing, in the wrong table, or with an invalid value."""

from collections.abc import Collection, Iterator, Mapping
from fractions import Fraction
from itertools import pairwise
from typing import Any, Final

from rubnoise.contact.births import BIRTHS
from rubnoise.contact.laws import LAWS
from rubnoise.contact.pulses import OFF_CENTRE
from rubnoise.scenario.document import SECTIONS, STRENGTH_LAWS, SWEEP, TOP, Document, Sliding, Sweeping, presence
from rubnoise.scenario.fields import Key, did_you_mean, keys_of
from rubnoise.scenario.layers import ALTERNATIVES, DAMPINGS, LOSSES
from rubnoise.scenario.scenario import CONTACT, RAYLEIGH, completed
from rubnoise.scenario.text import Layers, Path, Problem, toml_value
from rubnoise.units import LENGTH, RATIO, Quantity, Unfit

_CLOSE: Final = 1e-5  # relative, of a spread that is written in few digits
GRID, ZIP = "grid", "zip"
KNOWN: Final[Mapping[str, tuple[str, ...]]] = {
    **{name: tuple(keys_of(section)) for name, section in SECTIONS.items()},
    SWEEP: (*keys_of(Sweeping), GRID, ZIP),
}
"""The keys of each table, by its name."""

_OWN_SCALE: Final = ("empirical", "power")
_ANY_DISTANCE: Final = Sliding(distance=Quantity(Fraction(1), LENGTH))
_OF_LAW: Final = {
    name: (*(["spread"] if entry.takes_spread else []), *(each.name for each in entry.parameters), *entry.own_keys)
    for name, entry in {**LAWS, **STRENGTH_LAWS}.items()
}
OWN_KEYS: Final[Mapping[tuple[str, str], Mapping[str, Collection[str]]]] = {
    ("diameter", "law"): {name: _OF_LAW[name] for name in LAWS},
    ("strength", "law"): {name: _OF_LAW[name] for name in STRENGTH_LAWS},
    ("birth", "law"): {name: [each.name for each in entry.parameters] for name, entry in BIRTHS.items()},
    ("slider", "excitation"): {
        "friction": (),
        "base": ("asperity_height", "heights"),
        "velocity-weakening": ("slope",),
    },
    ("slider", "coupling"): {"one-way": (), "two-way": ("cells",)},
    ("load", "motion"): {"first-order": (), "free": ("restitution", "impact_damping")},
}
"""The keys that go with each value of a choice alone, by the choice; a file must have them, but for NOT_NEEDED."""

NOT_NEEDED: Final = {"heights", "cells", "restitution", "impact_damping"}.union(
    *(law.optional for law in LAWS.values())
)
INSTEAD: Final = {name: entry.with_spread for name, entry in {**LAWS, **STRENGTH_LAWS}.items()}
"""The law to advise in place of one that takes no spread."""


def read(layers: Layers) -> tuple[Document, set[str], list[Problem]]:
    """Return the document, the tables of it that are wrong, and the problems of all keys, alone and in combination.

    A default stands in for a wrong table. If a line is broken, it may be any key of its table; if it is in no table,
    of any.
    """
    layers = completed(layers)
    paths = [problem.path for problem in layers.problems if problem.path != ("format",)]
    broken = {name for path in paths for name in (path[:1] if len(path) > 1 else SECTIONS)}
    unsound = [each for each in _unsound_problems(layers) if each.path[0] not in broken]
    problems = [*unsound, *(each for each in _rule_problems(layers) if each.path[0] not in broken)]
    wrong = broken | {each.path[0] for each in problems if each.is_missing or each in unsound}
    needed: dict[str, Any] = {name: {} for name in SECTIONS if presence(name) == "needed"}
    right: dict[str, Any] = {
        "format": TOP["format"].sample,
        "interface": SECTIONS["interface"](),
        "sliding": _ANY_DISTANCE,
    }
    for name, given in {**needed, **layers.data}.items():
        if name in TOP:
            right |= values_of(TOP, layers, (), {name: given}, problems)
        elif name not in SECTIONS:
            problems.append(unknown(layers, (name,)))
        elif isinstance(given, Mapping):
            known = keys_of(SECTIONS[name])
            problems += [unknown(layers, (name, key)) for key in given if key not in known]
            lacking = [key for key, about in known.items() if about.is_needed and key not in given]
            problems += [missing(layers, (name, key)) for key in lacking if name not in broken]
            before = len(problems)
            values = values_of(known, layers, (name,), given, problems)
            if lacking or len(problems) > before:
                wrong.add(name)
            elif name not in wrong:
                right[name] = SECTIONS[name](**values)
        elif given is not None or presence(name) != "optional":
            wrong.add(name)
            problems.append(layers.problem((name,), "needs a table", f"a line [{name}] with its keys below"))
    both = {"interface", "diameter"}
    if wrong & both and "mean" in layers.table("diameter"):
        wrong |= both  # area or count follow from the diameter
        right |= {name: SECTIONS[name]() for name in both}
    return Document(**right), wrong, problems


def values_of(
    known: Mapping[str, Key], layers: Layers, table: Path, given: Mapping[str, Any], problems: list[Problem]
) -> dict[str, Any]:
    """Return the values of the known keys of a table, without those that are refused, which join the problems."""
    values = {}
    for key, value in given.items():
        about = known.get(key)
        if about is None or (value is None and about.default is None and not about.is_needed):
            continue
        from_python = layers.origin((*table, key)).kind == "values"
        try:
            values[key] = about.kind.of_python(value) if from_python else about.kind.read(value)
        except Unfit as unfit:
            problems.append(layers.problem((*table, key), str(unfit), unfit.hint))
    return values


def missing(layers: Layers, path: Path, reason: str = "missing") -> Problem:
    """Return the problem of a missing key, shown at its table, with a right form."""
    table, key = path
    about = keys_of(SECTIONS[table])[key]
    form = about.form or f"{key} = {toml_value(about.sample)}"
    where = "" if isinstance(layers.data.get(table), dict) else f" in a table [{table}]"
    return layers.problem(path, reason, f"write {form}{where}", place=layers.key_place(path[:-1]))


def unknown(layers: Layers, path: Path) -> Problem:
    """Return the problem of an unknown key or table, with the nearest known one, or the table that has the key."""
    word, name = str(path[-1]), str(path[0])
    what = f"unknown {'table' if len(path) == 1 and isinstance(layers.data.get(name), dict) else 'key'}"
    homes = tuple(f"{section}.{word}" for section in SECTIONS if word in KNOWN[section])
    if name == SWEEP:
        homes = tuple(f"{SWEEP}.{GRID}.{home}" for home in homes[:2])
    known = KNOWN[name] if len(path) > 1 and name in KNOWN else (*TOP, *KNOWN)
    if homes and homes != (".".join(map(str, path)),):
        hint = f"did you mean {' or '.join(homes)}?"
    else:
        hint = did_you_mean(word, known) or f"known here: {', '.join(known)}"
    return layers.problem(path, what, hint, place=layers.key_place(path))


def _rule_problems(layers: Layers) -> Iterator[Problem]:
    """Yield the problems of combinations of keys in the file, whether their values are valid or not."""
    if isinstance(layers.data.get("slider"), dict):
        yield from _slider_problems(layers)
    if isinstance(layers.data.get("load"), dict):
        yield from _load_problems(layers)
    for name, choice in OWN_KEYS:
        yield from _own_problems(layers, name, choice)


def _unsound_problems(layers: Layers) -> Iterator[Problem]:
    """Yield the problems of combinations from which no contact, law or pulse can be made."""
    if "mean" in layers.table("diameter"):
        yield from _mean_problems(layers)
    elif isinstance(layers.data.get("interface", {}), dict):
        for ways in ALTERNATIVES["interface"]:
            yield from _one_of(layers, "interface", ways)
    yield from _offset_problems(layers)
    yield from _law_problems(layers)


def _one_of(layers: Layers, name: str, ways: tuple[tuple[str, ...], ...], *, needed: bool = True) -> Iterator[Problem]:
    """Refuse ways to say one thing of which two are given, or none, or only a part of one."""
    table = layers.table(name)
    given = [next(key for key in way if key in table) for way in ways if not table.keys().isdisjoint(way)]
    if len(given) > 1:
        yield _said_twice(layers, [(name, key) for key in given])
    elif given:
        (way,) = [way for way in ways if given[0] in way]
        lacking = [key for key in way if key not in table]
        yield from (missing(layers, (name, key), f"missing; {given[0]} needs it") for key in lacking)
    elif needed:
        yield missing(layers, (name, ways[0][0]))


def _mean_problems(layers: Layers) -> Iterator[Problem]:
    """Check what stands beside a mean diameter: either a count or an area, and a law without a scale of its own."""
    interface, (areas, _) = layers.table("interface"), ALTERNATIVES["interface"]
    given = [key for way in areas for key in way if key in interface]
    path, law = ("diameter", "mean"), _value(layers, "diameter", "law")
    if law in _OWN_SCALE:
        yield layers.problem(path, f'the law "{law}" has a mean of its own', "leave the mean out")
    mean, spread = _value(layers, *path), _value(layers, "diameter", "spread")
    absolute = isinstance(mean, Quantity) and isinstance(spread, Quantity) and spread.kind == LENGTH
    # Without its part below 0 a normal law that is much wider has a larger mean, wherever its centre lies.
    if law == "normal" and absolute and float(spread) > float(mean):
        yield layers.problem(("diameter", "spread"), "wider than the mean diameter", "at most the mean")
    if "patch_area" in interface:
        message = "a mean diameter says how large a junction is"
        yield layers.problem(("interface", "patch_area"), message, "keep exactly one of the two")
    elif given and "mean_junction_count" in interface:
        message = f"beside mean_junction_count and {given[0]} the mean diameter is already said"
        yield layers.problem(path, message, "keep two of the three")
    elif given:
        yield from _one_of(layers, "interface", areas)
    elif "mean_junction_count" not in interface:
        yield missing(layers, ("interface", "mean_junction_count"))
    if "calibration" in interface:
        message = "a mean diameter needs no calibration"
        yield layers.problem(("interface", "calibration"), message, "leave the calibration out")


def _load_problems(layers: Layers) -> Iterator[Problem]:
    """Check what a load that weighs needs, that its loss fits its motion, and that no key contradicts it."""
    if "speed" not in layers.table("sliding"):
        yield missing(layers, ("sliding", "speed"), "missing; the motion of a load that weighs needs it")
    if layers.table("interface").keys().isdisjoint({"load", "hardness"}):
        yield missing(layers, ("interface", "load"), "missing; a load that weighs is that of the interface")
    free = layers.table("load").get("motion") == "free"
    yield from _one_of(layers, "load", DAMPINGS, needed=not free)
    if free:
        yield from _one_of(layers, "load", LOSSES)
    for table, key, needed in ((name, key, value) for name, own in CONTACT.items() for key, value in own.items()):
        value = _value(layers, table, key)
        right = value in {needed, None}
        if key == "spread":
            ratio = isinstance(value, Quantity) and value.kind == RATIO
            right = ratio and abs(100.0 * float(value) / RAYLEIGH - 1.0) <= _CLOSE
        if not right:
            what = f"Rayleigh sizes ({needed})" if key == "spread" else f"{table}.{key} {needed}"
            hint = f'{key} = "{needed}", or leave it out: it is set'
            yield layers.problem((table, key), f"the theory of [load] is for {what}", hint)
    if _value(layers, "load", "motion") == "free" and _value(layers, "sliding", "start") == "empty":
        message = "free motion begins at rest on the summits that are there"
        yield layers.problem(("sliding", "start"), message, 'start = "stationary"')
    if _value(layers, "slider", "coupling") == "two-way":
        message = "two-way coupling is known at constant separation alone, not with a table [load]"
        yield layers.problem(("slider", "coupling"), message, 'coupling = "one-way"')


def _offset_problems(layers: Layers) -> Iterator[Problem]:
    if _value(layers, "pulse", "offset") != "uniform":
        return
    shape, law = _value(layers, "pulse", "shape"), _value(layers, "birth", "law")
    if shape is not None and shape not in OFF_CENTRE:
        message = f"lateral offsets are known for the {' and the '.join(OFF_CENTRE)}, not for the {shape}"
        yield layers.problem(("pulse", "offset"), message, 'shape = "lens"')
    if law not in {"poisson", None}:
        message = f"lateral offsets are known for Poisson births, not for {law} ones"
        yield layers.problem(("pulse", "offset"), message, 'birth.law = "poisson"')
    if _value(layers, "slider", "coupling") == "two-way":
        message = "lateral offsets are known with one-way coupling alone"
        yield layers.problem(("pulse", "offset"), message, 'slider.coupling = "one-way"')


def _value(layers: Layers, table: str, key: str) -> Any:
    """Return the value of a key, or its default; None if the value is refused where it is read."""
    about = keys_of(SECTIONS[table])[key]
    try:
        return about.kind.of_python(layers.table(table).get(key, about.default))
    except Unfit:
        return None


def _said_twice(layers: Layers, both: list[Path]) -> Problem:
    names = " and ".join(path[-1] for path in both)
    places = sorted(((layers.key_place(path), path) for path in both), key=lambda each: (each[0].rank, each[0].line))
    (first, _), (second, path) = places
    where = f"{first.source}:{first.line}" if first.line else first.source
    message = f"both {names} are given (the other at {where})"
    return layers.problem(path, message, "keep exactly one of the two", place=second)


def _slider_problems(layers: Layers) -> Iterator[Problem]:
    slider = layers.table("slider")
    excitation = slider.get("excitation", "friction")
    if "strength" not in layers.data and excitation != "base":
        yield missing(layers, ("strength", "mean"), "missing; a slider is driven by a force, which needs a strength")
    if "speed" not in layers.table("sliding"):
        yield missing(layers, ("sliding", "speed"), "missing; the motion of a slider needs a sliding speed")
    yield from _one_of(layers, "slider", DAMPINGS)
    if excitation in ("base", "velocity-weakening") and slider.get("coupling") == "two-way":
        message = f'the excitation "{excitation}" is known with one-way coupling alone'
        yield layers.problem(("slider", "coupling"), message, 'coupling = "one-way"')
    if excitation == "base" and "load" in layers.data:
        message = 'the excitation "base" is known only without a load that weighs'
        yield layers.problem(("slider", "excitation"), message, "leave [load] out")


def _law_problems(layers: Layers) -> Iterator[Problem]:
    """Refuse lists of a mixture of unequal length, and parameters of a law that must increase and do not."""
    weights, parts = (layers.table("diameter").get(key) for key in ("weights", "parts"))
    if isinstance(weights, list | tuple) and isinstance(parts, list | tuple) and len(weights) != len(parts):
        message = f"{len(weights)} weights for {len(parts)} parts"
        yield layers.problem(("diameter", "weights"), message, "one weight for each part")
    for name, table in ((name, layers.table(name)) for name in ("diameter", "strength")):
        entry = LAWS.get(str(table.get("law")))
        for low, high in pairwise(entry.ascending if entry else ()):
            least, most = table.get(low), table.get(high)
            if isinstance(least, int | float) and isinstance(most, int | float) and most <= least:
                yield layers.problem((name, high), f"must be larger than {name}.{low} = {least}")


def _own_problems(layers: Layers, name: str, choice: str) -> Iterator[Problem]:
    """Refuse keys that the value of a choice does not take, naming the one that does, and report missing ones."""
    table, takes, about = layers.table(name), OWN_KEYS[name, choice], keys_of(SECTIONS[name])[choice]
    word = table.get(choice, about.default or about.sample)
    for key in dict.fromkeys(key for keys in takes.values() for key in keys) if word in [*takes] else ():
        instead = INSTEAD[word] if key == "spread" else next(other for other in takes if key in takes[other])
        if key in table and key not in takes[word]:
            default = "" if choice in table else f', and "{word}" is the default'
            leave = f"leave the {key} out"
            hint = f'write {choice} = "{instead}", or {leave}' if instead else leave
            yield layers.problem((name, key), f'the {choice} "{word}" takes no {key}{default}', hint)
        if key in takes[word] and key not in table and key not in NOT_NEEDED:
            article = "an" if key[0] in "aeiou" else "a"
            yield missing(layers, (name, key), f'missing; the {choice} "{word}" needs {article} {key}')
