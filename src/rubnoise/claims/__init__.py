"""The claims of the paper and of its field, each tested by runs and by theory.

A claim has numbers as printed, as simulated and as theory has them, and a verdict that follows from these. Begin with
`claim`, then `catalogue`, which lists the paper's claims, and `ledger`, which lists those of the field.
"""
