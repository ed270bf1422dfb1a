"""The alternatives, each in a file of its own and written as a user of that tool would write it.

A peer takes its junctions from `Draws`, and writes tables with h5py: `tables.maker` does that for who has the whole
area before the motion.
"""
