"""Single changes of the values of a result, its columns and its groups; hashes of values are put right."""

from math import nan
from random import Random

import h5py
import numpy as np

from fuzz.changing import OF_HDF5, Change, Place, Places, columns, filled, put_values


def one_bit(file: h5py.File, random: Random) -> Places:
    """Turn a bit of a value."""
    path, column = random.choice([*filled(file)])
    values = column[:]
    bits = values.view(f"u{values.dtype.itemsize}")
    bits[random.randrange(bits.size)] ^= bits.dtype.type(1 << random.randrange(8 * bits.dtype.itemsize))
    put_values(column, values)
    return (Place(path=path),)


def one_value(file: h5py.File, random: Random) -> Places:
    """Set a value to something else."""
    path, column = random.choice([*filled(file)])
    values = column[:]
    row = random.randrange(values.size)
    choices = (0, 1, values[random.randrange(values.size)], values[row] * 2, nan if values.dtype.kind == "f" else 3)
    with np.errstate(over="ignore"):
        values[row] = np.asarray(random.choice(choices)).astype(values.dtype)
    put_values(column, values)
    return (Place(path=path),)


def swapped_values(file: h5py.File, random: Random) -> Places:
    """Exchange two values of a column."""
    path, column = random.choice([*filled(file)])
    values = column[:]
    first, second = random.randrange(values.size), random.randrange(values.size)
    values[[first, second]] = values[[second, first]]
    put_values(column, values)
    return (Place(path=path),)


def swapped_rows(file: h5py.File, random: Random) -> Places:
    """Exchange two rows of a group in all of its columns."""
    group = random.choice([name for name in file if name not in {"summary", "provenance"}])
    size = next(iter(file[group].values())).size
    first, second = random.randrange(size), random.randrange(size)
    for column in file[group].values():
        values = column[:]
        values[[first, second]] = values[[second, first]]
        put_values(column, values)
    return tuple(Place(path=f"/{group}/{name}") for name in file[group])


def scaled_column(file: h5py.File, random: Random) -> Places:
    """Multiply a column, as with another unit."""
    path, column = random.choice([(path, column) for path, column in filled(file) if column.dtype.kind == "f"])
    put_values(column, column[:] * random.choice((1e-3, 1e3, 1.0 + 1e-6, -1.0)))
    return (Place(path=path),)


def swapped_columns(file: h5py.File, random: Random) -> Places:
    """Exchange the values of two columns of a type and length, or the columns themselves with all they say."""
    found = dict(columns(file))
    pairs = [
        (one, two)
        for one in found
        for two in found
        if one < two and found[one].shape == found[two].shape and found[one].dtype == found[two].dtype
    ]
    one, two = random.choice(pairs)
    if random.random() < 0.5:
        first, second = found[one][:], found[two][:]
        put_values(found[one], second)
        put_values(found[two], first)
    else:
        file.move(one, "/passing")
        file.move(two, one)
        file.move("/passing", two)
    return Place(path=one), Place(path=two)


def lost_column(file: h5py.File, random: Random) -> Places:
    """Take a column away."""
    path, _ = random.choice([*columns(file)])
    del file[path]
    return (Place(path=path),)


def lost_group(file: h5py.File, random: Random) -> Places:
    """Take a group away."""
    name = random.choice([*file])
    del file[name]
    return (Place(path=f"/{name}"),)


def invented_object(file: h5py.File, random: Random) -> Places:
    """Add a column, a group, a link or a type."""
    owner = random.choice([file, *file.values()])
    name = random.choice(("colour", "remark", "junctions2", "real_contact_area_old"))
    kind = random.randrange(5)
    if kind == 0:
        owner[name] = np.zeros(7)
    elif kind == 1:
        owner.create_group(name)["below"] = 1
    elif kind == 2:
        owner[name] = h5py.SoftLink("/trace/distance")
    elif kind == 3:
        owner[name] = file["trace/distance"]
    else:
        owner[name] = np.dtype("<f4")
    return (Place(path=f"{owner.name.rstrip('/')}/{name}"),)


def other_storage(file: h5py.File, random: Random) -> Places:
    """Store a column in another type, length or manner."""
    path, column = random.choice([*columns(file)])
    values, attributes = column[:], {name: column.attrs[name] for name in column.attrs if name not in OF_HDF5}
    del file[path]
    kind = random.randrange(5)
    if kind == 0:
        made = file.create_dataset(path, data=values.astype("<f4"))
    elif kind == 1:
        made = file.create_dataset(path, data=values.astype(values.dtype.newbyteorder(">")))
    elif kind == 2:
        made = file.create_dataset(path, data=values[:-1])
    elif kind == 3:
        made = file.create_dataset(path, data=values, chunks=(max(1, values.size),), fletcher32=True)
    else:
        made = file.create_dataset(path, data=values[:, None])
    for name, value in attributes.items():
        made.attrs[name] = value
    return (Place(path=path),)


CHANGES: tuple[Change, ...] = (
    *(one_bit,) * 3,
    *(one_value,) * 2,
    *(swapped_values,) * 2,
    swapped_rows,
    scaled_column,
    swapped_columns,
    lost_column,
    lost_group,
    invented_object,
    other_storage,
)
