"""The compiled heart: sums over lives, at evenly spaced positions and over the cells between them.

Begin with `deposit` in `choice`, the only door. It takes a `Grid` of positions, lives in order of birth and a weight
for each, and returns

    total     sum_j w_j a((s - b_j)/d_j) at the positions wanted, a the area over d^2 of a life of its shape
    moments   int_0^1 of the same times P_i(2y - 1) dy, i = 0, 1, 2, over the cell that ends at each position

With w = d^2 the total is the real contact area, with w = psi d^2 the friction force. A life counts while
birth <= s < departure; departure is infinite while nothing has ended it.

Which way is taken
==================

h is the distance between positions. Errors are those of one life, largest over all phases. Costs are for each life and
position, area alone and with moments, as multiples of the cheapest, which takes 0.7 ns if vectors have 512 bits.

=================  ======================================  ====================================  ==========
life               way                                     error                                 cost
=================  ======================================  ====================================  ==========
lens, d >= 96 h    `fine`, by `taylor` and `ends`: power   area 2.5e-15 d^2; moments 1e-14,      1, 2
                   series for every eight positions,       1e-13, 5e-12 d^2
                   summed over all lives before they
                   are worked out; 24 positions at each
                   end by polynomials
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

A life of few positions is not worth a series: its ends would meet. If no life is fine, the passes of that way are
left out; if few are coarse, only the cells are looked at in which they live. Areas that are not wanted, as over the
cells of divided ticks, are not computed. The series of `fine` take most of the time of ordinary runs, and `coarse` that
of coarse ticks: there the slider's step divides a tick, so that a life has some hundred cells however few ticks it has.

What must stay
==============

- Bits. Sums go in order of birth, products are fused where the source says ``fused`` and nowhere else, no fastmath.
  What is stored must not depend on where a run is cut into ranges: chunks of series begin at whole multiples from the
  run's start, and how many terms a panel has depends on its place in its life alone. tests/golden has their hashes.
- Space around. Vectors read and write beyond what is wanted: a `Grid` has a whole block of positions before and
  after it, and what lands there is thrown away. ``gathered`` is zero before and after each call.
- The polynomials come from tools/kernel_coefficients.py, fitted at 45 digits; a test holds the files against the tool.

What is easily got wrong
========================

- Numba's cache looks at a function's own file alone. What is compiled into other files, functions and constants alike,
  has to be under `rubnoise.compiling.SOURCES`, or the old machine code goes on being used; a test finds a missing one.
- A kernel that is called with another kind of array (a slice with steps, an array that can't be written) is compiled
  again, for seconds, in the middle of a run. tests/verification/test_engines.py counts.
- `compiling.compiled_bare` counts no references: such a function makes no arrays. Slices are fine.
- What is in `lanes` works inside compiled functions only; ``kernel.py_func`` of what uses it does not.
- The compiler cannot know that two arrays are apart. What a loop needs of one is read before it writes to another.
"""

from rubnoise.simulation.kernels.choice import Deposited, Scratch, deposit, peak_areas
from rubnoise.simulation.kernels.grid import Grid, count_live

__all__ = ["Deposited", "Grid", "Scratch", "count_live", "deposit", "peak_areas"]
