"""Result files: their schema, a writer that leaves either a whole file or none, and a reader that trusts nothing."""
