"""Sweeps: many runs from one file, made by several processes, resumed after any crash.

A journal lists the runs that are done, a pool or a cluster makes the others, and an index shows all of them. Begin
with `conduct`, which carries out a sweep from start to end, then `execution`.
"""
