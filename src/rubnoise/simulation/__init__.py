"""The simulation: junctions live and die along the sliding distance, and their sum moves a slider.

A run goes from block to block, with SimPy events or without, and hands its rows to a sink. Begin with `run`, then
`block`; `junctions` has the processes, `slider` and `coupled` the motion.
"""
