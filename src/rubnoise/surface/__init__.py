"""From two measured surfaces to their noise: exact theory of Gaussian surfaces, beside what is counted on the maps.

Begin with `sliding.py`: it takes two height maps under a load and gives all answers. `gaussian.py` is the theory.
"""
