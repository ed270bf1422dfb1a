"""The comparison of a run with the theory of its scenario, one file for each part of the run.

Each part sums what it needs from chunks of columns, and returns figures with scores, or reasons why it has none. Begin
with `findings`, then `trace`, the one pass over the ticks.
"""
