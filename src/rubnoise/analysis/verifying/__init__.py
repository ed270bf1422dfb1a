"""The verification of a result file: its attributes composed again, and its run played again, row by row.

Begin with `findings`, then `replay`, which finds most, and `columns`, which checks rows without the engine.
"""
