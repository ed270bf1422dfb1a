"""From a measured trace back to its junctions: number, size, spread and strength, with intervals.

Read `inference`, which goes from trace to answer; then `periodogram` for the bands and what is expected of them,
`populations` for the laws of sizes, `fitting` for the fit, `estimates` for its intervals, `honesty` for
the tests of the trace.
"""
