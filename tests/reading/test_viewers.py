"""A viewer that follows NeXus finds what to draw by itself: the default of the root, its signal and its axis."""

from pathlib import Path

import h5py
import numpy as np
import pytest

SIGNALS = {
    "trace": ("real_contact_area", "distance"),
    "slider": ("displacement", "time"),
    "junctions": ("diameter", "junction"),
    "life_curve": ("area_fraction", "u"),
}


def text(owner: h5py.HLObject, name: str) -> str:
    value = owner.attrs[name]
    assert isinstance(value, bytes)
    return value.decode()


def default_plot(file: h5py.File) -> h5py.Group:
    """Follow the attribute ``default`` from the root to a group of data, as NeXus version 3 says."""
    found: h5py.Group = file
    while text(found, "NX_class") != "NXdata":
        found = found[text(found, "default")]
    return found


def problems(group: h5py.Group) -> list[str]:
    """Return what keeps a viewer from drawing a group: NeXus' rules for data of one dimension."""
    if "signal" not in group.attrs or text(group, "signal") not in group:
        return ["no signal"]
    signal = group[text(group, "signal")]
    axes = [name.decode() for name in group.attrs["axes"]]
    found = [f"no axis {name}" for name in axes if name not in group]
    found += [] if len(axes) == signal.ndim else ["not one axis a dimension"]
    found += [f"{name} has another length" for name in axes if name in group and group[name].shape != signal.shape]
    others = [name.decode() for name in group.attrs.get("auxiliary_signals", ())]
    return found + [f"{name} in another unit" for name in others if text(group[name], "units") != text(signal, "units")]


def test_the_default_of_the_file_is_the_trace(folder: Path) -> None:
    with h5py.File(folder / "fig5.h5") as file:
        assert text(file, "NX_class") == "NXroot"
        assert default_plot(file).name == "/trace"


@pytest.mark.parametrize("name", SIGNALS)
def test_every_group_of_columns_can_be_drawn(name: str, folder: Path) -> None:
    with h5py.File(folder / "fig5.h5") as file:
        group = file[name]
        assert problems(group) == []
        assert (text(group, "signal"), group.attrs["axes"].tolist()) == (SIGNALS[name][0], [SIGNALS[name][1].encode()])


@pytest.mark.parametrize(
    ("attribute", "value", "problem"),
    [
        ("signal", b"nothing", "no signal"),
        ("axes", [b"nothing"], "no axis nothing"),
        ("axes", [b"distance", b"distance"], "not one axis a dimension"),
        ("auxiliary_signals", [b"friction_force"], "friction_force in another unit"),
    ],
)
def test_what_viewers_cannot_draw_is_found(attribute: str, value: object, problem: str, folder: Path) -> None:
    with h5py.File(folder / "fig5.h5", "r+") as file:
        file["trace"].attrs[attribute] = np.array(value)
        assert problems(file["trace"]) == [problem]
