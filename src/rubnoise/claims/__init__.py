"""The claims of the paper, each tested by runs and by theory.

A claim has numbers as printed, as simulated and as theory has them, and a verdict that follows from these. Begin with
`claim`, then `catalogue`, which lists all of them.
"""
