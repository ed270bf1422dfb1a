"""Shot-noise theory: exact averages of a contact and its slider, and how far a finite run may differ from them.

No simulation is imported here, so each can be tested with the other. Begin with `campbell`, the cumulants of area and
force, then `spectrum` and `sampling`; `exact` collects all of it for one model.
"""
