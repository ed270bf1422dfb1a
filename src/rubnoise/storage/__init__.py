"""Result files: written so that a final name means a complete file, and read so that no file can do harm.

Only this package knows HDF5. Begin with `schema`, what is in a file; then `format`, `writer` and `output` for writing,
`reader` and `objects` for reading, `index` for the index of a sweep.
"""
