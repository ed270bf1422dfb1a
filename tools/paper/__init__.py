"""The claims of the paper and of its field, tested by runs and by theory, and Figures 2 to 9 of the paper."""
