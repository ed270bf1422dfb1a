"""Studies whose results the pages tell: each is a module with a `main`, called by `python tools/studies NAME`."""
