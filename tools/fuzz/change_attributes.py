"""Single changes of what a result says beside its values: texts, numbers, units, hashes, scales."""

import json
from math import nan, nextafter
from random import Random
from typing import Any

import h5py
import numpy as np

from fuzz.changing import Change, Place, Places, columns, numbers, objects, put_text, texts
from rubnoise.storage.schema import HASH

TEXTS = ("um", "mm", "s", "noise", "", "0", "{}", "[]", "é", "2026-11-21T05:09:14Z")


def one_character(file: h5py.File, random: Random) -> Places:
    """Change, add or take away a character of a text."""
    place, text = random.choice([*texts(file)])
    at = random.randrange(len(text) + 1)
    new = chr(random.randrange(32, 127))
    changed = random.choice((text[:at] + new + text[at + 1 :], text[:at] + new + text[at:], text[:at] + text[at + 1 :]))
    put_text(file[place.path], place.attribute, changed)
    return (place,)


def another_text(file: h5py.File, random: Random) -> Places:
    """Put another text in the place of one."""
    place, _ = random.choice([*texts(file)])
    put_text(file[place.path], place.attribute, random.choice(TEXTS))
    return (place,)


def swapped_texts(file: h5py.File, random: Random) -> Places:
    """Exchange two texts of an object, or the same one of two objects."""
    found = dict(texts(file))
    first = random.choice([*found])
    like = [other for other in found if (other.path == first.path) != (other.attribute == first.attribute)]
    second = random.choice(like or [first])
    for place, other in ((first, second), (second, first)):
        put_text(file[place.path], place.attribute, found[other])
    return first, second


def another_number(file: h5py.File, random: Random) -> Places:
    """Change a number, by its last bit or by much."""
    place, value = random.choice([*numbers(file)])
    if isinstance(value, int):
        changed: float = value + random.choice((1, -1, 1000))
    else:
        changed = random.choice((nextafter(value, 9e99), value * (1 + 1e-3), value * 1.5, -value, 1000.0, 0.0, nan))
    file[place.path].attrs.create(place.attribute, changed, dtype="<i8" if isinstance(value, int) else "<f8")
    return (place,)


def digit_of_a_number_in_json(file: h5py.File, random: Random) -> Places:
    """Change one number or text in an attribute that holds JSON."""
    owner = file["provenance"]
    name = random.choice(("scenario_resolved", "propagator_constants", "software", "environment"))
    told = json.loads(owner.attrs[name])
    inner = [(table, key) for table in (told, *filter(_is_table, told.values())) for key in table]
    if not inner:
        return one_character(file, random)
    table, key = random.choice([(table, key) for table, key in inner if not isinstance(table[key], dict)])
    table[key] = _altered(table[key], random)
    put_text(owner, name, json.dumps(told, ensure_ascii=name != "scenario_resolved"))
    return (Place(path="/provenance", attribute=name),)


def key_of_a_scenario(file: h5py.File, random: Random) -> Places:
    """Take a key out of the scenario, be it that of the text or the resolved one."""
    owner = file["provenance"]
    if random.random() < 0.5:
        told = json.loads(owner.attrs["scenario_resolved"])
        table = random.choice([told, *filter(_is_table, told.values())])
        del table[random.choice([*table])]
        put_text(owner, "scenario_resolved", json.dumps(told, ensure_ascii=False))
        return (Place(path="/provenance", attribute="scenario_resolved"),)
    lines = owner.attrs["scenario_toml"].decode().split("\n")
    del lines[random.choice([n for n, line in enumerate(lines) if "=" in line])]
    put_text(owner, "scenario_toml", "\n".join(lines))
    return (Place(path="/provenance", attribute="scenario_toml"),)


def lost_attribute(file: h5py.File, random: Random) -> Places:
    """Take an attribute away."""
    place = random.choice([Place(path=path, attribute=name) for path, owner in objects(file) for name in owner.attrs])
    del file[place.path].attrs[place.attribute]
    return (place,)


def invented_attribute(file: h5py.File, random: Random) -> Places:
    """Add an attribute."""
    path, owner = random.choice([*objects(file)])
    name = random.choice(("remark", "valid_min", "Units", "xxh3_64", "force_mean", "velocity_mean_standard_error"))
    owner.attrs[name] = random.choice((1.0, 7, np.bytes_(b"text"), "of any length", [1.0, 2.0]))
    return (Place(path=path, attribute=name),)


def another_type(file: h5py.File, random: Random) -> Places:
    """Store the value of an attribute in another type."""
    values: list[tuple[Place, str | float]] = [*texts(file), *numbers(file)]
    place, value = random.choice(values)
    owner = file[place.path]
    if isinstance(value, str):
        other: Any = random.choice((value, np.bytes_(value.encode()), [np.bytes_(value.encode())]))
    else:
        other = random.choice((np.float32(value), np.array([value]), np.bytes_(repr(value).encode())))
    del owner.attrs[place.attribute]
    owner.attrs[place.attribute] = other
    return (place,)


def flags(file: h5py.File, random: Random) -> Places:
    """Change what the bits of a state mean."""
    owner = file["junctions/state"]
    if random.random() < 0.5:
        masks = owner.attrs["flag_masks"].copy()
        masks[random.randrange(masks.size)] ^= 1 << random.randrange(8)
        owner.attrs.create("flag_masks", masks)
        return (Place(path="/junctions/state", attribute="flag_masks"),)
    words = owner.attrs["flag_meanings"].decode().split()
    random.shuffle(words)
    put_text(owner, "flag_meanings", " ".join(words))
    return (Place(path="/junctions/state", attribute="flag_meanings"),)


def units_of_all(file: h5py.File, _random: Random) -> Places:
    """Say mm where it is um, in every column."""
    changed = {path: column.attrs["units"].decode().replace("um", "mm") for path, column in columns(file)}
    for path, units in changed.items():
        put_text(file[path], "units", units)
    return tuple(Place(path=path, attribute="units") for path in changed)


def hash_of_a_column(file: h5py.File, random: Random) -> Places:
    """Change a digit of a hash."""
    path, column = random.choice([*columns(file)])
    digits = [*column.attrs[HASH].decode()]
    at = random.randrange(len(digits))
    digits[at] = random.choice("0123456789abcdef")
    put_text(column, HASH, "".join(digits))
    return (Place(path=path),)


def scale(file: h5py.File, random: Random) -> Places:
    """Take a column from its scale, or attach another one."""
    scales = [other for _, other in columns(file) if other.is_scale]
    path, column = random.choice([each for each in columns(file) if "DIMENSION_LIST" in each[1].attrs])
    other = own = column.dims[0][0]
    if random.random() < 0.5:
        column.dims[0].detach_scale(own)
    else:
        other = random.choice([each for each in scales if each != own])
        column.dims[0].attach_scale(other)
    return Place(path=path, attribute="DIMENSION_LIST"), Place(path=other.name, attribute="REFERENCE_LIST")


CHANGES: tuple[Change, ...] = (
    *(one_character,) * 3,
    another_text,
    *(swapped_texts,) * 2,
    *(another_number,) * 3,
    *(digit_of_a_number_in_json,) * 2,
    key_of_a_scenario,
    lost_attribute,
    invented_attribute,
    another_type,
    flags,
    units_of_all,
    hash_of_a_column,
    scale,
)


def _is_table(value: object) -> bool:
    return isinstance(value, dict) and bool(value)


def _altered(value: Any, random: Random) -> Any:
    if isinstance(value, str):
        at = random.randrange(len(value) + 1)
        return value[:at] + random.choice("0123456789.abc ") + value[at + 1 :]
    if isinstance(value, int):
        return value + random.choice((1, -1, 10))
    return random.choice((nextafter(value, 9e99), value * 1.5, -value))
