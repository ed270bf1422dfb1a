"""A first run: a scenario, its run, pictures, and exact theory beside them; a marimo notebook, and a script."""

import marimo

__generated_with = "0.25.2"
app = marimo.App(width="medium", app_title="A first run")


@app.cell
def _():
    import marimo as mo
    import matplotlib.pyplot as plt
    import numpy as np

    import rubnoise

    return mo, np, plt, rubnoise


@app.cell
def _(mo):
    mo.md(r"""
    # A first run

    rubnoise simulates the noise of rubbing surfaces. Two rough surfaces touch only at small spots, the *junctions*.
    Junctions are born, grow, shrink and die while the surfaces slide. Their number and area fluctuate, so the friction
    force fluctuates, and a slider on a spring vibrates.

    This notebook makes one run, looks at it, and compares it with theory. It needs no file and no network.
    """)
    return


@app.cell
def _(rubnoise):
    scenario = rubnoise.example("paper/fig5")
    scenario
    return (scenario,)


@app.cell
def _(mo):
    mo.md(r"""
    ## What to expect

    The real contact area is the sum of many random lives, and theory knows its mean and spread before any run.
    Guess first: with 20 junctions on average, by how many per cent does the area vary?
    """)
    return


@app.cell
def _(rubnoise, scenario):
    theory = rubnoise.exact(scenario)
    print(f"junctions: mean {theory.count_mean:.4g}, std {theory.count_std:.4g}")
    print(f"area: mean {theory.area.mean:.4g} um^2, std {theory.area.std:.4g} um^2")
    print(f"so the area varies by {100.0 * theory.area.std / theory.area.mean:.0f} %")
    return (theory,)


@app.cell
def _(mo):
    mo.md(r"""
    ## Run it

    `simulate` keeps the run in memory. `rubnoise.run(scenario, "fig5.h5")` writes it into an HDF5 file instead; the
    bits are the same.
    """)
    return


@app.cell
def _(rubnoise, scenario):
    run = rubnoise.simulate(scenario, seed=7)
    run
    return (run,)


@app.cell
def _(mo):
    mo.md(r"""
    ## Look at it

    A column is an array with a unit. Here are the first half second of the force and of the slider's motion.
    """)
    return


@app.cell
def _(plt, run):
    _time = run.slider["time"][:]
    _shown = _time < 0.5
    _figure, _panes = plt.subplots(2, 1, figsize=(8.0, 4.0), sharex=True, layout="constrained")
    for _axes, _name in zip(_panes, ("friction_force", "displacement"), strict=True):
        _axes.plot(_time[_shown], run.slider[_name][_shown], color="#0072b2")
        _axes.set_ylabel(f"{_name.replace('_', ' ')} ({run.slider[_name].units})")
    _panes[-1].set_xlabel("time (s)")
    _figure
    return


@app.cell
def _(mo):
    mo.md(r"""
    Ready-made pictures show the same beside theory: "trace", "slider", "psd", "histogram", "acf", "lives" and more.
    """)
    return


@app.cell
def _(run):
    run.plot("psd")
    return


@app.cell
def _(mo):
    mo.md(r"""
    ## One junction

    Nothing is averaged away: each junction has its row, and its area at any distance follows from it.
    """)
    return


@app.cell
def _(np, plt, run):
    junction = run.junction(17)
    _distance = np.linspace(junction.birth_distance, junction.death_distance, 200)
    _figure, _axes = plt.subplots(figsize=(6.4, 3.0), layout="constrained")
    _axes.plot(_distance, junction.area(_distance), color="#0072b2")
    _axes.set(xlabel="sliding distance (µm)", ylabel="area of junction 17 (µm²)", ylim=(0.0, None))
    _figure
    return (junction,)


@app.cell
def _(mo):
    mo.md(r"""
    ## Is it right?

    `compare` holds the run against theory, one law after the other. z is the difference in standard errors; about
    one in twenty may lie beyond 2.
    """)
    return


@app.cell
def _(run):
    comparison = run.compare()
    assert comparison.passed
    comparison
    return (comparison,)


@app.cell
def _(mo):
    mo.md(r"""
    ## Change one parameter

    Five speeds, five runs. At a higher speed the same force passes faster, and more of its power reaches the natural
    frequency of the slider; beyond that, the power spreads over more frequencies and less of it is there.
    """)
    return


@app.cell
def _(np, plt, rubnoise, scenario):
    _speeds = [0.25, 0.5, 1.0, 2.0, 4.0]
    _runs = [
        rubnoise.simulate(scenario.replace({"sliding.speed": f"{_speed} mm/s", "run.engine": "batch"}))
        for _speed in _speeds
    ]
    _found = [_run.slider["displacement"].std() for _run in _runs]
    _exact = [rubnoise.exact(_run.scenario).slider.displacement_std for _run in _runs]
    _figure, _axes = plt.subplots(figsize=(6.4, 3.4), layout="constrained")
    _axes.loglog(_speeds, _found, "o", color="#0072b2", label="simulated")
    _axes.loglog(_speeds, _exact, color="#d55e00", label="exact")
    _axes.set_xticks(_speeds, map(str, _speeds))
    _axes.set_xticks([], minor=True)
    _axes.set(xlabel="sliding speed (mm/s)", ylabel="std of the displacement (µm)")
    _axes.legend(frameon=False)
    # Fast runs last few decay times of the slider, so their spread is less certain.
    assert np.all(np.abs(np.array(_found) / _exact - 1.0) < 0.6)
    _figure
    return


@app.cell
def _(mo):
    mo.md(r"""
    ## To try

    - Which of the columns of `run.junctions` do you need for the area at one distance? Check with `run.trace`.
    - Increase `interface.mean_junction_count` to 80. By how much does the relative spread of the area change?
    - Give the run another seed. Which numbers change, and which do not?
    """)
    return


if __name__ == "__main__":
    app.run()
