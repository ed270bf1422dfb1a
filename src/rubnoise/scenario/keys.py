"""Find problems of keys: unknown, missing, in the wrong table, or with an invalid value."""

from collections.abc import Collection, Iterator, Mapping
from fractions import Fraction
from itertools import pairwise
from typing import Any, Final

from rubnoise.contact.births import BIRTHS
from rubnoise.contact.laws import LAWS
from rubnoise.contact.pulses import OFF_CENTRE
from rubnoise.errors import did_you_mean
from rubnoise.scenario.document import SECTIONS, STRENGTH_LAWS, SWEEP, TOP, Document, Sliding, Sweeping, presence
from rubnoise.scenario.fields import Key, keys_of
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
    paths = [problem.path for problem in layers.problems if not problem.is_missing]
    broken = {name for path in paths for name in (path[:1] if len(path) > 1 else SECTIONS)}
    top, problems = values_of(TOP, layers, ())
    problems += [unknown(layers, (name,)) for name in layers.data if name not in (*TOP, *SECTIONS)]
    tables: dict[str, dict[str, Any]] = {}
    wrong = set(broken)
    for name, section in SECTIONS.items():
        given = layers.data.get(name, {} if presence(name) == "needed" else None)
        if isinstance(given, Mapping):
            known = keys_of(section)
            tables[name], refused = values_of(known, layers, (name,))
            lacking = [key for key, about in known.items() if about.is_needed and key not in given]
            problems += [*refused, *(unknown(layers, (name, key)) for key in given if key not in known)]
            problems += [missing(layers, (name, key)) for key in lacking if name not in broken]
            wrong |= {name} if lacking or refused else set()
        elif name in layers.data and (given is not None or presence(name) != "optional"):
            wrong.add(name)
            problems.append(layers.problem((name,), "needs a table", f"a line [{name}] with its keys below"))
    rules = _Rules(layers, tables)
    unsound = list(rules.of_contact())
    found = [each for each in (*unsound, *rules.of_choices()) if each.path[0] not in broken]
    wrong |= {each.path[0] for each in found if each.is_missing or each in unsound}
    both = {"interface", "diameter"}
    if wrong & both and "mean" in layers.table("diameter"):
        wrong |= both  # area or count follow from the diameter
    right = {name: SECTIONS[name](**values) for name, values in tables.items() if name not in wrong}
    stand_in = {"format": TOP["format"].sample, "interface": SECTIONS["interface"](), "sliding": _ANY_DISTANCE}
    return Document(**{**stand_in, **top, **right}), wrong, [*found, *problems]


def values_of(known: Mapping[str, Key], layers: Layers, table: Path) -> tuple[dict[str, Any], list[Problem]]:
    """Return the values of the known keys of a table, without those that are refused, and these."""
    values, problems = {}, []
    given = layers.table(table[0]) if table else layers.data
    for key, about in known.items():
        value = given.get(key)
        if key not in given or (value is None and about.default is None and not about.is_needed):
            continue
        from_python = layers.origin((*table, key)).kind == "values"
        try:
            values[key] = about.kind.of_python(value) if from_python else about.kind.read(value)
        except Unfit as unfit:
            problems.append(layers.problem((*table, key), str(unfit), unfit.hint))
    return values, problems


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
    meant = () if homes == (".".join(map(str, path)),) else homes
    hint = did_you_mean(word, known, meant) or f"known here: {', '.join(known)}"
    return layers.problem(path, what, hint, place=layers.key_place(path))


class _Rules:
    """The rules for combinations of keys; ``tables`` are the values that can be read."""

    def __init__(self, layers: Layers, tables: Mapping[str, Mapping[str, Any]]) -> None:
        self.layers, self.tables = layers, tables

    def value(self, table: str, key: str) -> Any:
        """Return the value of a key, or its default; None if it is refused."""
        refused = key in self.layers.table(table) and key not in self.tables.get(table, {})
        return None if refused else self.tables.get(table, {}).get(key, keys_of(SECTIONS[table])[key].default)

    def wrong(self, table: str, key: str, message: str, hint: str = "") -> Problem:
        return self.layers.problem((table, key), message, hint)

    def lacks(self, table: str, key: str, why: str = "") -> Problem:
        return missing(self.layers, (table, key), f"missing; {why}" if why else "missing")

    def of_contact(self) -> Iterator[Problem]:
        """Yield the problems of combinations from which no contact, law or pulse can be made."""
        if "mean" in self.layers.table("diameter"):
            yield from self.mean()
        elif isinstance(self.layers.data.get("interface", {}), dict):
            for ways in ALTERNATIVES["interface"]:
                yield from self.one_of("interface", ways)
        if self.value("pulse", "offset") == "uniform":
            yield from self.offset()
        yield from self.laws()

    def of_choices(self) -> Iterator[Problem]:
        """Yield the problems of other combinations, whether their values are valid or not."""
        if isinstance(self.layers.data.get("slider"), dict):
            yield from self.slider()
        if isinstance(self.layers.data.get("load"), dict):
            yield from self.load()
        for name, choice in OWN_KEYS:
            yield from self.own(name, choice)

    def one_of(self, name: str, ways: tuple[tuple[str, ...], ...], *, needed: bool = True) -> Iterator[Problem]:
        """Refuse ways to say one thing of which two are given, or none, or only a part of one."""
        table = self.layers.table(name)
        given = [next(key for key in way if key in table) for way in ways if not table.keys().isdisjoint(way)]
        if len(given) > 1:
            places = [(self.layers.key_place((name, key)), key) for key in given]
            (first, _), (second, key) = sorted(places, key=lambda each: (each[0].rank, each[0].line))
            where = f"{first.source}:{first.line}" if first.line else first.source
            message = f"both {' and '.join(given)} are given (the other at {where})"
            yield self.layers.problem((name, key), message, "keep exactly one of the two", place=second)
        elif given:
            (way,) = [way for way in ways if given[0] in way]
            yield from (self.lacks(name, key, f"{given[0]} needs it") for key in way if key not in table)
        elif needed:
            yield self.lacks(name, ways[0][0])

    def mean(self) -> Iterator[Problem]:
        """Check what stands beside a mean diameter: either a count or an area, and a law without a scale of its own."""
        interface, (areas, _) = self.layers.table("interface"), ALTERNATIVES["interface"]
        given = [key for way in areas for key in way if key in interface]
        mean, spread, law = (self.value("diameter", key) for key in ("mean", "spread", "law"))
        if law in _OWN_SCALE:
            yield self.wrong("diameter", "mean", f'the law "{law}" has a mean of its own', "leave the mean out")
        # Without its part below 0 a normal law that is much wider has a larger mean, wherever its centre lies.
        if law == "normal" and mean and spread and spread.kind == LENGTH and spread > mean:
            yield self.wrong("diameter", "spread", "wider than the mean diameter", "at most the mean")
        if "patch_area" in interface:
            message = "a mean diameter says how large a junction is"
            yield self.wrong("interface", "patch_area", message, "keep exactly one of the two")
        elif given and "mean_junction_count" in interface:
            message = f"beside mean_junction_count and {given[0]} the mean diameter is already said"
            yield self.wrong("diameter", "mean", message, "keep two of the three")
        elif given:
            yield from self.one_of("interface", areas)
        elif "mean_junction_count" not in interface:
            yield self.lacks("interface", "mean_junction_count")
        if "calibration" in interface:
            message = "a mean diameter needs no calibration"
            yield self.wrong("interface", "calibration", message, "leave the calibration out")

    def offset(self) -> Iterator[Problem]:
        shape, law, known = self.value("pulse", "shape"), self.value("birth", "law"), "lateral offsets are known"
        if shape is not None and shape not in OFF_CENTRE:
            message = f"{known} for the {' and the '.join(OFF_CENTRE)}, not for the {shape}"
            yield self.wrong("pulse", "offset", message, 'shape = "lens"')
        if law not in {"poisson", None}:
            message = f"{known} for Poisson births, not for {law} ones"
            yield self.wrong("pulse", "offset", message, 'birth.law = "poisson"')
        if self.value("slider", "coupling") == "two-way":
            yield self.wrong("pulse", "offset", f"{known} with one-way coupling alone", 'slider.coupling = "one-way"')

    def laws(self) -> Iterator[Problem]:
        """Refuse lists of a mixture of unequal length, and parameters of a law that must increase and do not."""
        weights, parts = (self.value("diameter", key) for key in ("weights", "parts"))
        if weights and parts and len(weights) != len(parts):
            message = f"{len(weights)} weights for {len(parts)} parts"
            yield self.wrong("diameter", "weights", message, "one weight for each part")
        for name in ("diameter", "strength"):
            entry = LAWS.get(str(self.layers.table(name).get("law")))
            for low, high in pairwise(entry.ascending if entry else ()):
                least, most = self.value(name, low), self.value(name, high)
                if least is not None and most is not None and most <= least:
                    yield self.wrong(name, high, f"must be larger than {name}.{low} = {least}")

    def slider(self) -> Iterator[Problem]:
        slider = self.layers.table("slider")
        excitation = slider.get("excitation", "friction")
        if "strength" not in self.layers.data and excitation != "base":
            yield self.lacks("strength", "mean", "a slider is driven by a force, which needs a strength")
        if "speed" not in self.layers.table("sliding"):
            yield self.lacks("sliding", "speed", "the motion of a slider needs a sliding speed")
        yield from self.one_of("slider", DAMPINGS)
        if excitation in ("base", "velocity-weakening") and slider.get("coupling") == "two-way":
            message = f'the excitation "{excitation}" is known with one-way coupling alone'
            yield self.wrong("slider", "coupling", message, 'coupling = "one-way"')
        if excitation == "base" and "load" in self.layers.data:
            message = 'the excitation "base" is known only without a load that weighs'
            yield self.wrong("slider", "excitation", message, "leave [load] out")

    def load(self) -> Iterator[Problem]:
        """Check what a load that weighs needs, that its loss fits its motion, and that no key contradicts it."""
        if "speed" not in self.layers.table("sliding"):
            yield self.lacks("sliding", "speed", "the motion of a load that weighs needs it")
        if self.layers.table("interface").keys().isdisjoint({"load", "hardness"}):
            yield self.lacks("interface", "load", "a load that weighs is that of the interface")
        free = self.layers.table("load").get("motion") == "free"
        yield from self.one_of("load", DAMPINGS, needed=not free)
        if free:
            yield from self.one_of("load", LOSSES)
        for table, key, needed in ((name, key, value) for name, own in CONTACT.items() for key, value in own.items()):
            value = self.value(table, key)
            right, what = value in {needed, None}, f"{table}.{key} {needed}"
            if key == "spread":
                ratio = isinstance(value, Quantity) and value.kind == RATIO
                right = ratio and abs(100.0 * float(value) / RAYLEIGH - 1.0) <= _CLOSE
                what = f"Rayleigh sizes ({needed})"
            if not right:
                hint = f'{key} = "{needed}", or leave it out: it is set'
                yield self.wrong(table, key, f"the theory of [load] is for {what}", hint)
        if free and self.value("sliding", "start") == "empty":
            message = "free motion begins at rest on the summits that are there"
            yield self.wrong("sliding", "start", message, 'start = "stationary"')
        if self.value("slider", "coupling") == "two-way":
            message = "two-way coupling is known at constant separation alone, not with a table [load]"
            yield self.wrong("slider", "coupling", message, 'coupling = "one-way"')

    def own(self, name: str, choice: str) -> Iterator[Problem]:
        """Refuse keys that the value of a choice does not take, naming the one that does, and report missing ones."""
        table, takes, about = self.layers.table(name), OWN_KEYS[name, choice], keys_of(SECTIONS[name])[choice]
        word = table.get(choice, about.default or about.sample)
        for key in dict.fromkeys(key for keys in takes.values() for key in keys) if word in [*takes] else ():
            if key in table and key not in takes[word]:
                instead = INSTEAD[word] if key == "spread" else next(other for other in takes if key in takes[other])
                default = "" if choice in table else f', and "{word}" is the default'
                leave = f"leave the {key} out"
                hint = f'write {choice} = "{instead}", or {leave}' if instead else leave
                yield self.wrong(name, key, f'the {choice} "{word}" takes no {key}{default}', hint)
            if key in takes[word] and key not in table and key not in NOT_NEEDED:
                article = "an" if key[0] in "aeiou" else "a"
                yield self.lacks(name, key, f'the {choice} "{word}" needs {article} {key}')
