"""What holds for every test."""

from hypothesis import settings

# The same examples every time, and no clock: a test that fails on a slow machine says nothing.
settings.register_profile("repeatable", deadline=None, derandomize=True)
settings.load_profile("repeatable")
