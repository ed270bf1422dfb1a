"""Everything that rubnoise does, as Python functions: load a scenario, run it, open a result, compute the theory.

`run.py` and `record.py` hold what most users meet first: a run in a file or in memory, with its columns.
`running.py` makes runs, `sweeps.py` makes sweeps, whose results `sweep_result.py` holds.
Begin with `run` in `running.py`: it calls `play` in `runs/making.py`, which connects simulation and storage.
"""
