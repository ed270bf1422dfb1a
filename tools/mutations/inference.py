"""Faults of what a trace is expected to show, of the intervals found, and of the tests of the trace."""

from __future__ import annotations

from mutations.mutant import one

MUTANTS = (
    one(
        "aliases left out of the bands",
        "test_bands_are_expected_as_an_estimate_sees_them",
        "total = near + far",
        "total = near + 0.0 * far",
    ),
    one(
        "bands that know nothing of the removed mean",
        "test_bands_are_expected_as_an_estimate_sees_them",
        "tail - self._bands.mean_part * table.zero)",
        "tail)",
    ),
    one(
        "a slope by size without its sixth power",
        "test_derivatives_are_those_of_the_expectation",
        "(by_log_diameter - table.power * tail) + 6.0 * mean",
        "(by_log_diameter - table.power * tail) + 5.0 * mean",
    ),
    one(
        "a mean that grows with the square of the diameter",
        "test_number_size_spread_and_strength_lie_where_they_are",
        "contact.strength * problem.pulse.life_integral(1) * third * contact.place.diameter**3",
        "contact.strength * problem.pulse.life_integral(1) * third * contact.place.diameter**2",
    ),
    one(
        "half the junctions",
        "test_number_size_spread_and_strength_lie_where_they_are",
        "fit.problem.pulse.mean_life * contact.births * place.diameter,",
        "0.5 * fit.problem.pulse.mean_life * contact.births * place.diameter,",
    ),
    one(
        "clipped sensors taken for good",
        "test_a_bad_trace_is_refused_by_name_and_line",
        "_CLIPPED: Final = 1e-3",
        "_CLIPPED: Final = 1.0",
    ),
)
