"""Everything that rubnoise does, as Python functions: load a scenario, run it, open a result, compute the theory.

`run.py` holds what most users meet first: a run, with its columns.
`running.py` makes runs, in files or in memory, and sweeps, whose results `sweep_result.py` holds.
Begin with `run` in `running.py`: it calls `play` in `runs/making.py`, which connects simulation and storage.
"""
