"""The compiled loops: sums over lives, at evenly spaced positions and over the cells between them.

Begin with `deposit` in `choice`, which calls all of them. It takes a `Grid` of positions, lives in order of birth and a
weight for each, and returns

    total     sum_j w_j a((s - b_j)/d_j) at the positions wanted; a is the area over d^2 of a life of this shape
    moments   int_0^1 of the same sum times P_i(2y - 1) dy, i = 0, 1, 2, over the cell that ends at each position

With w = d^2 the total is the real contact area, with w = psi d^2 the friction force. A life counts while
birth <= s < departure; departure is infinite unless the life was ended early.

Which method is used
====================

h is the distance between positions. An error is that of one life, the largest over all phases. A cost is for one life
and position, area alone and with moments, relative to the cheapest, which takes 0.7 ns with vectors of 512 bits.

=================  ======================================  ====================================  ==========
life               method                                  error                                 cost
=================  ======================================  ====================================  ==========
lens, d >= 96 h    `fine` with `taylor`: power series      area 2.5e-15 d^2; moments 1e-14,      1, 2
                   for every eight positions, summed       1e-13, 5e-12 d^2
                   over all lives before they are
                   evaluated; 24 positions at each end
                   by polynomials
lens, d < 96 h     `coarse`: polynomials of area and       area 1e-15 d^2; moments, as they are  2, 7
                   integrals, eight positions together;    differences of integrals, 2e-14 d^2
                   moments are differences over a cell     times 1, d/h and (d/h)^2
lens, d >= 96 h,   area by `coarse`; moments by `lens`:    moments 1e-14 d^2                     2, 100
ended early        quadrature in sqrt(u) in each cell
triangle           `triangle`: chords and kinks            1e-15 d^2                             1, 2 to 5
parabola           `parabola`: chords, bends and kinks     1e-15 d^2                             1, 2 to 5
lens off the       `off_centre`: polynomials of area;      area 1e-15 d^2; moments 1e-12,        3, 5 to 30
centre line        moments by quadrature in cells near     5e-11, 1e-9 d^2
                   the ends and the turn, by power
                   series (`off_centre_series`) elsewhere
=================  ======================================  ====================================  ==========

A life of few positions is not worth a series, because its ends would meet. If no life is fine, the passes of `fine` are
left out; if few lives are coarse, only the cells in which they live are visited. Areas that are not wanted, as over the
cells of divided ticks, are not computed. The series of `fine` take most of the time of ordinary runs. With coarse ticks
`coarse` does: the slider's step then divides a tick, so that a life has about a hundred cells however few its ticks.

What must stay
==============

- The bits. Sums go in order of birth, products are fused where the source says ``fused`` and nowhere else, no fastmath.
  Stored values must not depend on where a run is cut into ranges. So chunks of series begin at whole multiples from the
  run's start, and the number of terms of a panel depends only on its place in its life. tests/golden has hashes.
- The space around. Vectors read and write beyond the positions wanted. So a `Grid` has a whole block of positions
  before and after them, and the values there are discarded. ``gathered`` is zero before and after each call.
- The polynomials come from tools/kernel_coefficients.py, fitted at 45 digits; a test compares the files with the tool.

Typical mistakes
================

- Numba's cache only checks the file of a function itself. Functions and constants that are compiled into other files
  must be listed in `rubnoise.compiling.SOURCES`, or the old machine code is still used; a test finds missing ones.
- A kernel that is called with another kind of array (a slice with steps, a read-only array) is compiled again, which
  takes seconds in the middle of a run. tests/verification/test_engines.py counts.
- `compiling.compiled_bare` counts no references, so such a function must not make arrays. Slices are fine.
- The functions of `lanes` work inside compiled functions only; ``kernel.py_func`` of a kernel that uses them does not.
- The compiler cannot know that two arrays do not overlap. So a loop reads what it needs of one before it writes to
  another.
"""

from rubnoise.simulation.kernels.choice import Deposited, Scratch, deposit, peak_areas
from rubnoise.simulation.kernels.grid import Grid, count_live

__all__ = ["Deposited", "Grid", "Scratch", "count_live", "deposit", "peak_areas"]
