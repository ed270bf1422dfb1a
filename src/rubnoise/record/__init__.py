"""The rows of a run, and the protocols between the code that makes, stores and reads them.

A `Sink` takes rows as a run makes them, a `Reader` gives them back, and `MemoryRecord` is both, without a file. All are
in `rows`; `moments` sums them up.
"""
