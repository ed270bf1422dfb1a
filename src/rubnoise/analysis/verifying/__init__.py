"""A result file verified, one file for each check.

Every check works out again what the file says, by formulas that the simulation does not share, and notes the first
place that is wrong. Begin with `findings`, then `contact`, which sums area and force at every tick again.
"""
