"""Faults of what is measured in a run, of the scores it gets, and of the checks of a file against itself."""

from __future__ import annotations

from mutations.mutant import one

MUTANTS = (
    one(
        "deviations for scores",
        "test_a_score_counts_standard_errors",
        "return (self.observed - self.expected) / self.standard_error",
        "return self.observed - self.expected",
    ),
    one(
        "scatter of batches for the error of their mean",
        "test_errors_of_independent_values_are_the_textbook_ones",
        "means.std(axis=0, ddof=1) / sqrt(means.shape[0])",
        "means.std(axis=0, ddof=1)",
    ),
    one(
        "one tail in the bound of a family",
        "test_the_bound_of_a_family_is_bonferronis",
        "ndtri(0.5 * error / max(count, 1))",
        "ndtri(error / max(count, 1))",
    ),
    one(
        "segments of a spectrum with their mean",
        "test_it_is_what_scipy_finds",
        "rfft((parts - parts.mean(axis=1, keepdims=True)) * self._window, axis=1)",
        "rfft(parts * self._window, axis=1)",
    ),
    one(
        "one-sided Kolmogorov tails",
        "test_the_tail_is_that_of_the_exact_law",
        "2.0 * float(smirnov(count,",
        "1.0 * float(smirnov(count,",
    ),
    one(
        "autocovariance over all values, not pairs",
        "test_covariances_are_those_of_the_whole_record_over_their_pairs",
        "pairs = np.maximum(self._count - np.arange(self._reach + 1), 0).astype(np.float64)",
        "pairs = np.maximum(self._count - 0 * np.arange(self._reach + 1), 0).astype(np.float64)",
    ),
    one(
        "neighbours that were born before left out",
        "test_of_a_simulated_run_all_lives_sum_up_to_the_trace",
        "np.flatnonzero((birth <= stop) & (death >= start))",
        "np.flatnonzero((birth <= stop) & (birth >= start))",
    ),
    one(
        "or for and in conditions",
        "test_and_or_not_mean_what_they_mean_in_python",
        "np.logical_and.reduce([part.chosen(rows) for part in self.parts])",
        "np.logical_or.reduce([part.chosen(rows) for part in self.parts])",
    ),
    one(
        "rows not compared with the play",
        "test_what_cannot_be_is_told_and_breaks_nothing[junctions/state-900-2]",
        'notes.equal(f"/{group}/{name}", first_row, found, values[: found.size])',
        "notes.equal(name, first_row, found, found)",
    ),
    one(
        "lives that an intervention ended played to their natural death",
        "test_lives_that_an_intervention_ended_are_played_again[one at a time]",
        'Tee((compared, tally)), engine="batch", ended=ended)',
        'Tee((compared, tally)), engine="batch")',
    ),
    one(
        "ends of lives known before they happen",
        "test_lives_that_an_intervention_ended_are_played_again[one at a time]",
        "np.where(rows.departure > wake, natural, rows.departure)",
        "rows.departure",
    ),
    one(
        "areas of the textbook given any room",
        "test_a_fault_of_the_engine_itself_is_seen_by_the_textbook",
        "return area, allowed + count * SUM * area",
        "return area, allowed + count * 1e-9 * area",
    ),
    one(
        "a loudest sample at full scale",
        "test_the_file_tells_the_physical_scale",
        "PEAK: Final = 10.0 ** (-3.0 / 20.0)",
        "PEAK: Final = 1.0",
    ),
    one(
        "end term of the mean force subtracted",
        "test_a_constant_force_is_balanced",
        "(self.dissipated + 2.0 * self.reverse_work + self.stored) / (self.speed * self.time)",
        "(self.dissipated + 2.0 * self.reverse_work - self.stored) / (self.speed * self.time)",
    ),
    one(
        "work of reversals taken back once",
        "test_the_end_term_is_added_and_a_reversal_counts_twice",
        "self.friction_work - 2.0 * self.reverse_work",
        "self.friction_work - 1.0 * self.reverse_work",
    ),
    one(
        "work of a life that was alive at the start from its birth on",
        "test_the_work_of_friction_is_that_of_the_areas",
        "before = self._so_far(np.maximum(-birth, 0.0) / diameter)",
        "before = np.zeros_like(birth)",
    ),
)
