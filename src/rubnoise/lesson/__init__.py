"""The page of lessons for a classroom: one HTML file, with a simulation of its own in JavaScript.

Python gives it the settings and junctions of a scenario; all that moves is in `parts`. Begin with `page`, which puts
the file together.
"""
