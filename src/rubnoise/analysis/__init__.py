"""Analysis of the rows of a run: figures with errors, comparisons with theory, verification, sound.

Code here reads rows through `rubnoise.record.rows` and never opens a file. Begin with `figures` for the figures of a
run, `comparison` for a run beside its theory, `records` and `spectra` for estimates, `where` for conditions.
"""
