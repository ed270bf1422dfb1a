"""Shot-noise theory: what a contact and its slider do on average, exactly, and how far a finite run may differ.

No simulation is imported here, so either can be tested with the other. Begin with `campbell`, the cumulants of area and
force, then `spectrum` and `sampling`; `exact` gathers all of it for one model.
"""
