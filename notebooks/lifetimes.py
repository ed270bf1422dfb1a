"""Lives of junctions, read from a result file with h5py and xarray; a marimo notebook that runs as a script too."""

import marimo

__generated_with = "0.25.2"
app = marimo.App(width="medium", app_title="The lives of junctions")


@app.cell
def _():
    import atexit
    import tempfile
    from pathlib import Path

    import h5py
    import marimo as mo
    import matplotlib.pyplot as plt
    import numpy as np
    import xarray as xr

    import rubnoise
    from rubnoise.scenario.layers import shipped

    return Path, atexit, h5py, mo, np, plt, rubnoise, shipped, tempfile, xr


@app.cell
def _(mo):
    mo.md(r"""
    # The lives of junctions

    Two rough bodies touch only at a few small spots, called *junctions*. A junction is born at first touch, grows
    as the bodies slide, shrinks and dies. A run of rubnoise writes one row for each junction. Here we read these
    rows with tools that know nothing about rubnoise. How long do junctions live? When is the next one born? Which
    junctions do we meet when we look at a random moment?

    Before you run a cell, guess what it will show.
    """)
    return


@app.cell
def _(Path, atexit, rubnoise, shipped, tempfile):
    # Births at random, and diameters that differ widely, so that there are larger ones to meet.
    scenario = rubnoise.load(
        shipped("lessons/poisson.toml"),
        ["diameter.law=normal", "diameter.spread=40 %", "sliding.distance=10 mm"],
    )
    _folder = tempfile.TemporaryDirectory()
    atexit.register(_folder.cleanup)
    path = Path(_folder.name) / "lives.h5"
    rubnoise.run(scenario, path).close()
    theory = rubnoise.exact(scenario)
    return path, scenario, theory


@app.cell
def _(mo):
    mo.md(r"""
    ## What is in the file

    An HDF5 file is like a folder: it has groups, groups have datasets, and both have attributes. Every dataset here
    is one column with its unit.
    """)
    return


@app.cell
def _(h5py, path):
    with h5py.File(path) as _file:
        contents = [
            f"/{_group}/{_name}: {_data.size} rows, {_data.attrs['units'].decode()}"
            for _group in ("junctions", "trace", "slider")
            for _name, _data in _file[_group].items()
        ]
    print("\n".join(contents))
    return


@app.cell
def _(mo):
    mo.md(r"""
    ## One life

    A row says where a junction was born, and the diameter $d$ of its two circles. The whole life follows from these
    two numbers. The circles first touch at $s = 0$, cover each other at $s = d$ and separate at $s = 2d$. All
    junctions have the same curve with another scale. The file has it once, as `/life_curve`.
    """)
    return


@app.cell
def _(h5py, np, path, plt):
    with h5py.File(path) as _file:
        u, fraction = _file["life_curve/u"][:], _file["life_curve/area_fraction"][:]
        _row = {_name: _data[100] for _name, _data in _file["junctions"].items()}
    _distance = np.linspace(_row["birth_distance"], _row["death_distance"], 400)
    _area = _row["diameter"] ** 2 * np.interp((_distance - _row["birth_distance"]) / _row["diameter"], u, fraction)

    _figure, _axes = plt.subplots(figsize=(6.4, 3.0), layout="constrained")
    _axes.plot(_distance, _area, color="#0072b2")
    _axes.axhline(_row["diameter"] ** 2 / 3.0, color="#d55e00", label="d² / 3, the mean over its life")
    _axes.set(xlabel="sliding distance (µm)", ylabel="area of junction 100 (µm²)", ylim=(0.0, None))
    _axes.legend(frameon=False)
    assert abs(np.trapezoid(_area, _distance) / _row["life_distance"] / (_row["diameter"] ** 2 / 3.0) - 1.0) < 1e-3
    _figure
    return fraction, u


@app.cell
def _(mo):
    mo.md(r"""
    ## All lives

    `xarray` opens a group as a table with names and units. The column `state` says whether the start or the end of
    the record cut a life; a life with state 0 is complete.

    A life lasts $2d$, so lives spread like diameters. The wait for the next birth is different. Births are
    independent, so the gaps between them are exponential: many are short, and a few are long.
    """)
    return


@app.cell
def _(np, path, plt, scenario, xr):
    with xr.open_dataset(path, group="junctions", engine="h5netcdf") as _file:
        junctions = _file.load()
    whole = junctions.where(junctions["state"] == 0, drop=True)
    gaps = np.diff(whole["birth_distance"].values)
    _model = scenario.model()

    _figure, (_left, _right) = plt.subplots(1, 2, figsize=(8.0, 3.0), layout="constrained")
    _left.hist(whole["life_distance"], bins=40, density=True, color="#a9cce3")
    _left.axvline(_model.mean_life_distance, color="#d55e00", label="2 d_m")
    _left.set(xlabel="life (µm of sliding)", ylabel="density (1/µm)")
    _left.legend(frameon=False)
    _right.hist(gaps, bins=40, density=True, color="#a9cce3")
    _gap = np.linspace(0.0, gaps.max(), 200)
    _right.plot(_gap, _model.birth_rate * np.exp(-_model.birth_rate * _gap), color="#d55e00", label="exponential")
    _right.set(xlabel="gap between births (µm)", ylabel="density (1/µm)")
    _right.legend(frameon=False)
    # The mean of n exponential gaps has a relative standard error of 1/sqrt(n).
    assert abs(gaps.mean() * _model.birth_rate - 1.0) < 4.0 / np.sqrt(gaps.size)
    _figure
    return junctions, whole


@app.cell
def _(mo):
    mo.md(r"""
    ## Which junctions do we meet?

    Stop the sliding at some moment and measure the junctions that are alive. Are they like those that are born?

    Guess first, then look: they are **larger**. A wide junction lives longer, in proportion to its diameter, so we
    meet it more often. The junctions that we meet have the mean $E[d^2]/E[d]$ instead of $E[d]$. The same happens
    at a bus stop: a passenger who comes at a random time meets the long gaps more often.

    The age of a junction that we meet is uniform: every part of its life is equally likely.
    """)
    return


@app.cell
def _(junctions, np, plt, theory):
    _birth, _death = junctions["birth_distance"].values, junctions["death_distance"].values
    _diameter = junctions["diameter"].values
    # Looks farther apart than a life never meet the same junction twice.
    _looks = np.arange(50.0, 9_950.0, 40.0)
    _met = [np.flatnonzero((_birth <= _s) & (_s < _death)) for _s in _looks]
    _rows = np.concatenate(_met)
    _seen = _diameter[_rows]
    _age = (np.repeat(_looks, [_each.size for _each in _met]) - _birth[_rows]) / (2.0 * _seen)

    _figure, (_left, _right) = plt.subplots(1, 2, figsize=(8.0, 3.0), layout="constrained")
    _bins = np.linspace(0.0, _diameter.max(), 30)
    _left.hist(_diameter, bins=_bins, density=True, histtype="step", color="#000000", label="born")
    _left.hist(_seen, bins=_bins, density=True, color="#a9cce3", label="met alive")
    _left.axvline(theory.mean_diameter, color="#000000", ls=":")
    _left.axvline(theory.length_biased_mean_diameter, color="#d55e00", label="E[d²] / E[d]")
    _left.set(xlabel="diameter (µm)", ylabel="density (1/µm)")
    _left.legend(frameon=False)
    _right.hist(_age, bins=20, density=True, color="#a9cce3")
    _right.axhline(1.0, color="#d55e00")
    _right.set(xlabel="age over life", ylabel="density")

    print(f"born {_diameter.mean():.3f} um, met {_seen.mean():.3f} um in {_seen.size} meetings")
    print(f"exact {theory.mean_diameter:.3f} um and {theory.length_biased_mean_diameter:.3f} um")
    _error = _seen.std() / np.sqrt(_seen.size)
    assert abs(_seen.mean() - theory.length_biased_mean_diameter) < 4.0 * _error
    assert abs(_seen.mean() - theory.mean_diameter) > 4.0 * _error
    assert abs(_age.mean() - 0.5) < 4.0 / np.sqrt(12.0 * _age.size)
    _figure
    return


@app.cell
def _(mo):
    mo.md(r"""
    ## The rows are the run

    The real contact area is the sum of the areas of the live junctions. We check this: take a tick of `/trace`, find
    the junctions that are alive, and add their areas.
    """)
    return


@app.cell
def _(fraction, junctions, np, path, u, xr):
    with xr.open_dataset(path, group="trace", engine="h5netcdf") as _file:
        _trace = _file[["real_contact_area", "junction_count"]].isel(distance=slice(None, None, 997)).load()
    _s = _trace["distance"].values[:, np.newaxis]
    _birth, _death = junctions["birth_distance"].values, junctions["death_distance"].values
    _d = junctions["diameter"].values
    _alive = (_birth <= _s) & (_s < _death)
    _sum = np.where(_alive, _d**2 * np.interp((_s - _birth) / _d, u, fraction), 0.0).sum(axis=1)
    _off = float(np.abs(_sum - _trace["real_contact_area"].values).max())
    print(f"{len(_sum)} ticks, at most {_off:.1e} um^2 apart, and {_alive.sum(axis=1).mean():.2f} alive on average")
    assert np.array_equal(_alive.sum(axis=1), _trace["junction_count"].values)
    assert _off < 0.01
    return


@app.cell
def _(mo):
    mo.md(r"""
    ## To try

    - Halve the spread of the diameters. How does the difference between born and met diameters change? (It is
      proportional to the square of the spread.)
    - Set `birth.law=regular`. Which of the pictures change, and which do not?
    - Count the births in stretches of 10 µm. For random births, the variance of the counts equals their mean. What
      is it for regular births?
    """)
    return


if __name__ == "__main__":
    app.run()
