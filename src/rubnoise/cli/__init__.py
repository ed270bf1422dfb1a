"""The command line: a file for one command or a few, with their options, their JSON and the text that they print.

Begin with `app`, which maps each command to its function, and then read one command, such as `info` in `ask`.
`terminal`, `vocabulary`, `loading` and `derivation` hold what several commands share.
"""
