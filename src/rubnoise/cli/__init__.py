"""The command line: one file for each command, with its options, its JSON and the text that it prints.

Begin with `app`, which maps each command to its file, and then read one command, such as `info`.
`layout`, `progress`, `loading`, `commands` and `derivation` hold what several commands share.
"""
