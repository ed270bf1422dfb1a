"""The slider that pushes back: its two-way motion against the force of the contact, which is a function of distance.

G(s) = sum psi_i A_i(s) is the force that the contact can bear at the relative sliding distance s; it does not depend on
the slider. With the drive's speed V, w = V - x' and s = s_0 + V t - (x - x_0), both signed,

    slip     w != 0    m w' = k x + c (V - w) - G(s) sign(w)
    stick    w = 0     while |k x + c V| <= G(s); s is constant and x grows at V

===============  =======================================================================================
`fold`           a run, range of cells by range of cells: state and junctions in, state and columns out
`state`          the state of the slider between two ranges, and its bytes
`field`          G over cells of the grid: its moments, and G at any place of a cell if w is small
`motion`         slip, stick and reversal: which step comes next, compiled
`rest`           what happens at w = 0: arrival, the stick in closed form, breakaway, reversal
`steps`          the three steps in slip: uniform cells, event cells, and steps in time near w = 0
`rows`           the output: rows uniform in time, landmarks, first passages, integrals
`quadrature`     the nodes and matrices of collocation, from 36 digits and rounded once
`layout`         the places of values in the flat arrays that compiled functions pass to each other
===============  =======================================================================================

A position is a cell of the grid and an offset in it; a time is a row of the output and the time since then. So both
keep their accuracy however long a run is, and no bit depends on where it is cut into ranges. Every step begins and ends
at a place or time that the motion itself decides, or at a border of the grid, never where a range happens to end.
`rubnoise.simulation.two_way` draws the junctions behind the slider again, and those before the start.
"""
