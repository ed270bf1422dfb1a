"""From surfaces to noise: two measured scans, their junctions, and how they sound; a marimo notebook, and a script."""

import marimo

__generated_with = "0.25.2"
app = marimo.App(width="medium", app_title="From surfaces to noise")


@app.cell
def _():
    import io
    import wave
    from pathlib import Path

    import marimo as mo
    import matplotlib.pyplot as plt
    import numpy as np

    import rubnoise

    return Path, io, mo, np, plt, rubnoise, wave


@app.cell
def _(mo):
    mo.md(r"""
    # From surfaces to noise

    A scan says how high a surface is. A load presses two surfaces together, and only their highest points touch. When
    they slide, these junctions are born and die. This notebook takes two measured surfaces, counts their junctions,
    and lets you hear both.

    The scans lie in the folder `scans`, with their origin. Where they are missing, two surfaces from a seed stand in.
    """)
    return


@app.cell
def _(Path, rubnoise):
    _here = Path(globals().get("__file__", "notebook")).parent
    surfaces = {}
    for _seed, _name in enumerate(("x3p-2.x3p", "plu-1.plu"), start=1):
        _found = [each / _name for each in (_here / "scans", Path("scans")) if (each / _name).is_file()]
        if _found:
            surfaces[_name] = rubnoise.Surface.read(_found[0], form="polynomial")
        else:
            surfaces[_name] = rubnoise.Surface.synthesise(rolloff="64 um", cutoff="4 um", seed=_seed)
    for _surface in surfaces.values():
        print(_surface)
    return (surfaces,)


@app.cell
def _(mo):
    mo.md(r"""
    ## 1. How many junctions? That depends on the cut-off

    Look closer, and each patch of contact falls apart into smaller ones. So the number of junctions has no value
    without the shortest wave that counts. The curve says how it depends on this cut-off, at 1 % of the area.
    """)
    return


@app.cell
def _(plt, surfaces):
    _figure, _axes = plt.subplots(figsize=(6.4, 3.4), layout="constrained")
    for (_name, _surface), _colour in zip(surfaces.items(), ("#0072b2", "#d55e00"), strict=True):
        _cutoffs, _counts = _surface.count_over_cutoff(longest=f"{min(_surface.map.size) / 8} um")
        _axes.loglog(_cutoffs, _counts, "o-", ms=3, color=_colour, label=_name)
        assert _counts[0] > 3.0 * _counts[-1]
    _axes.set(xlabel="cut-off (µm)", ylabel="junctions")
    _axes.legend(frameon=False)
    _figure
    return


@app.cell
def _(mo):
    mo.md(r"""
    ## 2. Exact, and counted

    For Gaussian surfaces the number, the births and the whole noise follow from the spectra. Real surfaces are not
    quite Gaussian. So each surface is also pressed on itself, turned by half a turn, and its patches are counted. The
    ratio says how far to trust theory.
    """)
    return


@app.cell
def _(surfaces):
    contacts = {}
    for _name, _surface in surfaces.items():
        contacts[_name] = _surface.slide(
            cutoff=f"{8.0 * max(_surface.map.spacing)} um",
            longest=f"{min(_surface.map.size) / 8} um",
            load=f"{0.01 * _surface.map.area} mN",  # 1 % of the area at 1 GPa
            hardness="1 GPa",
        )
        _exact, _counted = contacts[_name].gaussian, contacts[_name].counted
        print(f"{_name}: {_exact.junction_count:.0f} junctions, {_counted.patch_count} counted, ", end="")
        print(f"a life of {_exact.mean_life:.2g} um; std over mean {_exact.relative_std:.2f}")
        assert 0.4 < contacts[_name].honesty < 2.5
        assert contacts[_name].refused == ()
    return (contacts,)


@app.cell
def _(contacts, np, plt):
    _figure, _panes = plt.subplots(1, 2, figsize=(8.0, 4.0), layout="constrained")
    for (_name, _contact), _axes in zip(contacts.items(), _panes, strict=True):
        _sum = _contact.track.heights + _contact.slider.heights
        _along, _across = _contact.slider.size
        _touching = np.where(_sum > np.quantile(_sum, 1.0 - _contact.share), 1.0, np.nan)
        _axes.imshow(_sum.T, cmap="Greys", origin="lower", extent=(0.0, _along, 0.0, _across))
        _axes.imshow(_touching.T, cmap="autumn", origin="lower", extent=(0.0, _along, 0.0, _across))
        _axes.set(title=_name, xlabel="along the sliding (µm)", ylabel="across (µm)")
    _figure
    return


@app.cell
def _(mo):
    mo.md(r"""
    ## 3. Their noise

    Each contact becomes a scenario: parabolic lives, Rayleigh's law of sizes, and births at random. Its area is the
    sum of all lives. Below is what the area remembers: on the surfaces, exactly, and in the scenario.
    """)
    return


@app.cell
def _(contacts, np, plt, rubnoise):
    _figure, _panes = plt.subplots(1, 2, figsize=(8.0, 3.2), layout="constrained")
    for (_name, _contact), _axes in zip(contacts.items(), _panes, strict=True):
        _lags, _moving = _contact.gaussian.curve
        _shown = _lags < 4.0 * _contact.gaussian.correlation_length
        _theory = rubnoise.exact(_contact.scenario)
        _axes.plot(_lags[_shown], _moving[_shown] / _moving[0], color="#d55e00", label="surfaces")
        _axes.plot(
            _lags[_shown],
            _theory.autocovariance(_lags[_shown]) / _theory.area.variance,
            color="#0072b2",
            label="scenario",
        )
        _axes.set(title=_name, xlabel="lag (µm)", ylabel="autocorrelation")
        _axes.legend(frameon=False)
        assert np.isfinite(_moving).all()
    _figure
    return


@app.cell
def _(contacts, io, np, rubnoise, wave):
    sounds = {}
    for _name, _contact in contacts.items():
        # A hundredth of a mean life is one of 44100 samples a second.
        _tick = _contact.scenario.model().mean_life_distance / 100.0
        _changes = {"sliding.distance": f"{88_200 * _tick} um", "output.tick": f"{_tick} um", "run.engine": "batch"}
        _area = rubnoise.simulate(_contact.scenario.replace(_changes)).trace["real_contact_area"][:]
        _noise = (_area - _area.mean()) / np.abs(_area - _area.mean()).max()
        sounds[_name] = io.BytesIO()
        with wave.open(sounds[_name], "wb") as _file:
            _file.setnchannels(1)
            _file.setsampwidth(2)
            _file.setframerate(44_100)
            _file.writeframes((23_000 * _noise).astype("<i2").tobytes())
        print(f"{_name}: {_area.std() / _area.mean():.3f} of the mean, sliding at {_tick * 44.1:.3g} mm/s")
    return (sounds,)


@app.cell
def _(mo):
    mo.md(r"""
    ## Hear them

    You hear the real contact area as it changes, less its mean, each on its own scale: first the X3P scan, then the
    PLU scan. A mean life lasts 2.3 ms.
    """)
    return


@app.cell
def _(mo, sounds):
    mo.audio(sounds["x3p-2.x3p"].getvalue())
    return


@app.cell
def _(mo, sounds):
    mo.audio(sounds["plu-1.plu"].getvalue())
    return


if __name__ == "__main__":
    app.run()
