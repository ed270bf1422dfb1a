"""The simulation: junctions live and die along the sliding distance, and their total force moves a slider.

A run is played block by block, with SimPy events or without, and its rows are written to a sink. Begin with `run`;
`junctions` has the processes, `linear`, `two_way` and `free` the motion.
"""
