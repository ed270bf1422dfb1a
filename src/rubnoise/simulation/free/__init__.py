"""A slider that is free to leave its contact: its normal motion under its load, exact from event to event.

Encounter i is a summit at the place x_i with the height h_i. With the slider's place s = V t and its separation z,

    overlap    delta_i = h_i - (s - x_i)^2 - z, and the encounter is in contact while it is positive
    motion     z'' + 2 zeta z' = P - 1, where P = (1/N) sum k_i delta_i

in the units c (along), s_0 (height), 1/omega_c (time) and W (load), omega_c^2 = W/(m s_0). r_i = delta_i' is the rate
of an overlap. With ``restitution`` e, k_i is 1 while the overlap grows and e^2 while it shrinks; with
``impact_damping`` beta, k_i is max(0, 1 + beta r_i). An encounter whose r_i stays 0 slides along the step of its force
(Filippov).

===============  =======================================================================================
`encounters`     places and heights from the seed, in blocks of distance and layers of height
`step`           sums over the encounters in contact, the power series of a step, and first times in it
`motion`         from event to event through a block, compiled
===============  =======================================================================================

Steps end at events and at borders of blocks, never at a tick. No bit of the motion depends on the number of layers of
encounters that have been drawn: if the separation would fall below the lowest one, the next layer is drawn and the step
is repeated.
"""
