"""Analysis of the rows of a run: figures with errors, comparisons with theory, verification, sound.

Code here reads rows through `rubnoise.record.reader` and never opens a file. Begin with `summary` for the figures of a
run, `comparison` for a run beside its theory, `verification` for a file, and `where` for conditions on junctions.
"""
