"""What `tools/survive.py` does to runs, and how it is told whether anything was lost."""
