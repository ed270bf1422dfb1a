"""The slider that pushes back: its motion two-way coupled to the force of the contact, which is a function of distance.

G(s) = sum psi_i A_i(s) is what the contact can bear at the relative sliding distance s, whatever the slider does. With
the drive's speed V, w = V - x' and s = s_0 + V t - (x - x_0), both signed,

    slip     w != 0    m w' = k x + c (V - w) - G(s) sign(w)
    stick    w = 0     while |k x + c V| <= G(s); s stands still and x grows at V

===============  =======================================================================================
`fold`           a run, range of cells by range of cells: state and junctions in, state and columns out
`state`          where the slider is between two ranges, and how that is written down
`past`           the junctions behind it, drawn again, and those before the start
`field`          G over cells of the grid: moments, and cell by cell what is needed of it where w is small
`motion`         slip, stick and reversal: which step comes next, compiled
`rest`           what happens at w = 0: arrival, the stick in closed form, breakaway, reversal
`steps`          the three steps in slip: uniform cells, event cells, and steps in time near w = 0
`rows`           what is written of it: rows uniform in time, landmarks, first passages, integrals
`quadrature`     the nodes and matrices of collocation, from 36 digits and rounded once
`layout`         where what lies in the flat arrays that compiled functions hand to each other
===============  =======================================================================================

Positions are a cell of a grid and an offset in it, times a row of the output and what is left over: both stay sharp
however far a run goes, and where it is cut into ranges changes no bit. Every step begins and ends at a place or time
that the motion itself decides, or at a border of the grid, never where a range happens to end.
"""
