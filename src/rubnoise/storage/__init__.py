"""Result files: written so that a final name means a complete file, and read so that no file can do harm.

Only this package knows HDF5. Begin with `schema`, what is in a file; then `format`, `writer` and `output` for writing,
`reader`, `objects` and `inventory` for reading, `index` for the index of a sweep, `measured` for files of others.
"""
