"""The contact: how junctions are born, how large and how strong they are, and how the area of each rises and falls.

Sizes and strengths have laws, births have laws, and a life has a pulse; each draws from uniforms or answers with exact
moments. Begin with `overlap`, the area of one junction, then `laws` and `births`.
"""
