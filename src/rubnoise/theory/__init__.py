"""Exact results for the stationary contact and the motions that it drives, without any run.

`sizes` and `unit_pulse` hold what is averaged; `second_order`, `moments` and `distribution` say what
the contact does, `motion` and `load` what it moves, `sampling` and `periodogram` how far a finite run errs.
"""
