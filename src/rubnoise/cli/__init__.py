"""The command line: one file for a command or two, with their options, their JSON and the text that they print.

Begin with `app`, which maps each command to its function, and then read one command, such as `info`.
`options`, `vocabulary`, `layout`, `progress`, `loading` and `derivation` hold what several commands share.
"""
