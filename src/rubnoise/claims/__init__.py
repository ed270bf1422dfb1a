"""The claims of the paper and of its field, each tested by runs and by theory.

A claim has printed, simulated and exact numbers, and a verdict that follows from them. Begin with `claim`, then
`catalogue`, which lists the claims of the paper and the statements of its field.
"""
