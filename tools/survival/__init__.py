"""What `tools/survive.py` does to runs, and how it checks whether anything was lost."""
