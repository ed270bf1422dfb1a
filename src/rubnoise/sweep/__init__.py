"""Sweeps: many runs from one file, made by several processes, resumed after any crash.

A journal says which runs are done, a pool or a cluster makes the others, and an index shows all of them. Begin with
`conduct`, the story of a sweep from beginning to end, then `execution`.
"""
