"""Making runs: one into its file, the many of a sweep over any executor, their index, and the check of all.

A point of a sweep is done if its file is there. Begin with `sweep`, which makes the missing ones, then `executors` and
`folder`.
"""
