"""A result file verified: what it says of itself composed again, and its run played again, row by row.

Begin with `findings`, then `replay`, which asks most of a file, and `areas`, which asks it without the engine.
"""
