"""From events to noise: how births and deaths of junctions add up to a sound; a marimo notebook, and a script."""

import marimo

__generated_with = "0.25.2"
app = marimo.App(width="medium", app_title="From events to noise")


@app.cell
def _():
    import atexit
    import subprocess
    import sys
    import tempfile
    from pathlib import Path

    import marimo as mo
    import matplotlib.pyplot as plt
    import numpy as np

    import rubnoise
    from rubnoise.scenario.layers import shipped

    return Path, atexit, mo, np, plt, rubnoise, shipped, subprocess, sys, tempfile


@app.cell
def _(mo):
    mo.md(r"""
    # From events to noise

    A junction is born, grows, shrinks and dies. Only its birth is random. Add some twenty junctions that are born
    independently, and you get noise: a force that never repeats, and a slider that vibrates.

    This notebook has four steps: the sum of the lives, its spread, its spectrum, and the slider. Each step has an
    exact law. A run beside it shows how much chance changes the result.
    """)
    return


@app.cell
def _(mo):
    count = mo.ui.slider(2, 80, value=20, label="junctions on average", show_value=True)
    births = mo.ui.dropdown(["poisson", "regular"], value="poisson", label="births")
    mo.hstack([count, births], justify="start")
    return births, count


@app.cell
def _(births, count, rubnoise, shipped):
    scenario = rubnoise.load(
        shipped("lessons/poisson.toml"),
        [
            f"interface.mean_junction_count={count.value}",
            f"birth.law={births.value}",
            "sliding.distance=10 mm",
            "run.engine=batch",
        ],
    )
    record = rubnoise.simulate(scenario)
    theory = rubnoise.exact(scenario)
    model = scenario.model()
    record
    return model, record, scenario, theory


@app.cell
def _(mo):
    mo.md(r"""
    ## 1. The sum

    The real contact area is the sum of the areas of the live junctions. It grows when, by chance, several are born
    close to each other, and shrinks when they die. Increase the number of junctions: the curve becomes calmer. Then
    choose regular births: the curve becomes nearly flat. So most of the noise comes from the randomness of births.
    """)
    return


@app.cell
def _(model, np, plt, record, theory):
    _end = round(8.0 * model.mean_life_distance / model.tick)
    _distance, _area = (record.trace[_name][:_end] for _name in ("distance", "real_contact_area"))
    _figure, _axes = plt.subplots(figsize=(8.0, 3.0), layout="constrained")
    _axes.axhspan(theory.area.mean - theory.area.std, theory.area.mean + theory.area.std, color="#fae8dd")
    _axes.axhline(theory.area.mean, color="#d55e00", label="exact mean ± std")
    _axes.plot(_distance, _area, color="#0072b2", label="simulated")
    _axes.set(xlabel="sliding distance (µm)", ylabel="real contact area (µm²)", ylim=(0.0, None))
    _axes.legend(frameon=False)
    assert np.all(_area >= 0.0)
    _figure
    return


@app.cell
def _(mo):
    mo.md(r"""
    ## 2. Its spread

    Births come at a rate $\lambda$, and each adds a pulse $A(s)$. Campbell's theorem says: the sum has the mean
    $\lambda \int A\,ds$ and the variance $\lambda \int A^2 ds$. For the overlap of two circles this gives

    $$\frac{\sigma}{\text{mean}} = \frac{3}{2}\sqrt{\frac{2\pi/3 - 64/45}{N}} = \frac{1.2298}{\sqrt{N}}.$$

    Four times as many junctions give half the noise. Each point below is a run, and the line is the law.
    """)
    return


@app.cell
def _(np, plt, rubnoise, shipped):
    counts = [2, 5, 10, 20, 50, 80]
    _found = []
    for _count in counts:
        _changes = [f"interface.mean_junction_count={_count}", "sliding.distance=10 mm", "run.engine=batch"]
        _area = rubnoise.simulate(rubnoise.load(shipped("lessons/poisson.toml"), _changes)).trace["real_contact_area"]
        _found.append(_area.std() / _area.mean())

    _n = np.geomspace(2.0, 80.0, 100)
    _law = 1.5 * np.sqrt(2.0 * np.pi / 3.0 - 64.0 / 45.0)
    _figure, _axes = plt.subplots(figsize=(6.4, 3.4), layout="constrained")
    _axes.loglog(_n, _law / np.sqrt(_n), color="#d55e00", label="1.2298 / √N")
    _axes.loglog(counts, _found, "o", color="#0072b2", label="simulated")
    _axes.set_xticks(counts, map(str, counts))
    _axes.set_xticks([], minor=True)
    _axes.set(xlabel="junctions on average", ylabel="std over mean of the area")
    _axes.legend(frameon=False)
    assert abs(_law - 1.2298) < 1e-4
    assert max(abs(np.array(_found) * np.sqrt(counts) / _law - 1.0)) < 0.15
    _figure
    return


@app.cell
def _(mo):
    mo.md(r"""
    ## 3. Its spectrum

    How long does the sum remember? For one life: after that, every junction that was alive has died. So the
    spectrum is flat for waves much longer than a life, and bends at about one cycle a life. Above, it falls as
    $k^{-4}$, because a life begins and ends smoothly and only has a kink in its middle. There is no white noise.
    """)
    return


@app.cell
def _(births, model, np, plt, record, theory):
    from scipy.signal import welch

    _cycles, _twice = welch(record.trace["real_contact_area"][:], 1.0 / model.tick, nperseg=8192)
    _k, _density = 2.0 * np.pi * _cycles[1:], 0.5 * _twice[1:]
    _fine = np.geomspace(_k[0], 30.0, 600)
    _figure, _axes = plt.subplots(figsize=(6.4, 3.8), layout="constrained")
    _axes.loglog(_k, _density, color="#0072b2", lw=0.9, label="simulated (Welch)")
    if births.value == "poisson":
        _axes.loglog(_fine, theory.spectral_density(_fine), color="#d55e00", label="exact")
        _low = _k < 1.0 / model.mean_life_distance
        assert 0.5 < _density[_low].mean() / theory.spectral_density(0.0) < 1.5
    _axes.axvline(2.0 * np.pi / model.mean_life_distance, color="#9a9a9a", ls=":", label="a cycle a life")
    _axes.set(xlabel="wavenumber (rad/µm)", ylabel="spectral density (µm⁴ per rad/µm)", ylim=(1e-6, None))
    _axes.legend(frameon=False)
    _figure
    return


@app.cell
def _(mo):
    mo.md(r"""
    ## 4. The slider

    The force is the area times a strength. Sliding at a speed $V$ turns wavenumbers into frequencies,
    $\omega = k V$. A mass on a spring responds most at its natural frequency. So the force has many frequencies,
    like a rumble, and the slider has mostly one, like a hum.
    """)
    return


@app.cell
def _(births, model, plt, record, theory):
    _time = record.slider["time"][:]
    _shown = _time < 0.5
    _figure, (_force, _place) = plt.subplots(2, 1, figsize=(8.0, 3.8), sharex=True, layout="constrained")
    _force.plot(_time[_shown], 1e-3 * record.slider["friction_force"][_shown], color="#0072b2")
    _force.set(ylabel="force (mN)")
    _place.plot(_time[_shown], record.slider["velocity"][_shown], color="#0072b2")
    _place.set(xlabel="time (s)", ylabel="velocity (µm/s)")
    _std = float(record.slider["velocity"].std())
    print(f"natural frequency {model.slider.natural_frequency:.1f} Hz")
    print(f"velocity: std {_std:.4g} um/s, exact {theory.slider.velocity_std:.4g} um/s")
    # The standard deviation of such a short record varies by some 5 per cent, and by more with few junctions.
    assert births.value == "regular" or abs(_std / theory.slider.velocity_std - 1.0) < 0.4
    _figure
    return


@app.cell
def _(mo):
    mo.md(r"""
    ## Hear it

    You hear the slider's velocity, ten times faster than it happened, so its 39 Hz become 390 Hz. The loudest sample
    is always 3 dB below full scale. So two runs sound equally loud; the printed scale shows which one is noisier.
    """)
    return


@app.cell
def _(Path, atexit, mo, rubnoise, scenario, subprocess, sys, tempfile):
    _folder = tempfile.TemporaryDirectory()
    atexit.register(_folder.cleanup)
    _run, _sound = Path(_folder.name) / "noise.h5", Path(_folder.name) / "noise.wav"
    rubnoise.run(scenario, _run).close()
    _listen = [sys.executable, "-m", "rubnoise", "listen", _run, "-o", _sound, "--speed-up", "10"]
    print(subprocess.run(_listen, capture_output=True, text=True, check=True).stdout)
    mo.audio(_sound.read_bytes())
    return


@app.cell
def _(mo):
    mo.md(r"""
    ## To try

    - Choose two junctions, then eighty. Which run has the louder hum, and by how much? Compare the printed scales.
    - Choose regular births. How much of the force remains, and how much of the hum?
    - Double the speed in the scenario (`sliding.speed=2 mm/s`). In which direction does the bend of the force's
      spectrum move? Does the tone of the slider move?
    """)
    return


if __name__ == "__main__":
    app.run()
