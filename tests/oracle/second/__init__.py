"""Every row of a run by other formulas than the engine's: sums, a one-way motion, slips and sticks; each a check.

They know the model, rows and theory, and nothing of the simulation; they share its compiler alone.
"""
