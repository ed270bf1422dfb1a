"""A run compared with the theory of its own scenario, one file for each part of the run.

Each part gathers what it needs while columns pass by, and gives figures with scores or reasons why there is none. Begin
with `findings`, then `trace`, the one pass over the ticks.
"""
