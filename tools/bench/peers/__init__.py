"""The alternatives, each in a file of its own and written as a user of that tool would write it.

A peer takes its junctions from `Draws`, returns an `Output`, and writes tables with h5py where it makes a whole run:
`tables.maker` does that for who has the whole area before the motion.
"""
