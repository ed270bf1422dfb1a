"""Every picture that rubnoise draws: of a run, of a sweep, of a scenario's theory, of surfaces and of an inference.

Begin with `catalogue`, which names the pictures of a run. `tracks` reads what they show along the run, with what theory
says of it; `panes` and `spectra` draw it; `style` holds colours, titles and legends.
"""
