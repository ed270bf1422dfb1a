"""Damaged and hostile files to throw at the program."""
