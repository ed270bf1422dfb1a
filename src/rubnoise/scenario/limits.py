"""The limits of scenarios, in one place."""

FILE_BYTES = 64 * 1024
# Of a file and those that it extends, together: what a reader does with them takes its time for each byte.
CHAIN_BYTES = 128 * 1024
LINE_CHARACTERS = 1000
EXTENDS_DEPTH = 8
# A text with a mistake is read once more without its line, so often at most.
SYNTAX_ERRORS = 20
TITLE_CHARACTERS = 200

RESULT_ROWS = 2_000_000_000
# A block of a run holds about eleven times as many junctions as are alive at once, at some 500 bytes each.
LIVE_JUNCTIONS = 1e6
# A point takes a millisecond to check, and all are checked before the first runs.
SWEEP_POINTS = 10_000
SWEEP_RUNS = 100_000
