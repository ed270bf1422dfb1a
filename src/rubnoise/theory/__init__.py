"""Exact results for the stationary contact and the motions that it drives, without any run.

`sizes` and `unit_pulse` hold what is averaged; `second_order` and `moments` say what the contact does, `motion` what
it moves, `coupling` how that acts back, `sampling` how far a finite run errs, `ancestors` what others have said.
"""
