"""Faults of what is called from Python: columns, traces, answers, changed scenarios, sweeps."""

from __future__ import annotations

from mutations.mutant import one

MUTANTS = (
    one(
        "backward slices forwards",
        "test_slices_are_those_of_an_array",
        "self._sliced(rows[-1], rows[0] + 1, -step)[::-1] if rows",
        "self._sliced(rows[-1], rows[0] + 1, -step) if rows",
    ),
    one(
        "a variance that forgets what was estimated",
        "test_reductions_of_numpy_hold_no_whole_column",
        "return self._moments().variance * self._rows / (self._rows - ddof)",
        "return self._moments().variance",
    ),
    one(
        "far rows read with all between them",
        "test_chosen_rows_are_read_panel_by_panel",
        "np.flatnonzero(np.diff(chosen // ROWS_AT_ONCE)) + 1)",
        "np.flatnonzero(np.diff(chosen // ROWS_AT_ONCE)))",
    ),
    one(
        "a measured column left in its own unit",
        "test_headers_carry_units_in_several_forms",
        "columns[head.name] = factor * np.ascontiguousarray(values)",
        "columns[head.name] = np.ascontiguousarray(values)",
    ),
    one(
        "rounded times taken for gaps",
        "test_times_rounded_when_they_were_written_are_uniform",
        "return uneven if resolution > 0.5 * self._usual and not rounded else uneven + 1.01 * resolution",
        "return uneven",
    ),
    one(
        "half of a one-sided spectrum",
        "test_estimates_are_those_of_scipy_and_numpy",
        "factor = 2.0 * scale**2",
        "factor = scale**2",
    ),
    one(
        "a comparison that forgives",
        "test_a_run_of_another_contact_does_not_pass",
        "return not self.found.outside",
        "return len(self.found.outside) < len(self.found.figures)",
    ),
    one(
        "a key that stays beside the one that replaces it",
        "test_defaults_follow_what_is_replaced",
        "values[table].pop(other, None)",
        "pass",
    ),
    one(
        "a short name for two keys",
        "test_short_names_are_those_that_mean_one_key",
        "for word, count in Counter(words.values()).items() if count == 1]",
        "for word, count in Counter(words.values()).items() if count >= 1]",
    ),
    one(
        "theory repeated for every replicate",
        "test_what_is_expected_comes_once_a_point",
        "summary_theory(model) if point.replicate == 0 else {}",
        "summary_theory(model)",
    ),
    one(
        "an ended junction still there",
        "test_a_junction_that_was_ended_early_is_gone_from_then_on",
        "(s < self.death_distance)",
        "(s <= self.death_distance)",
    ),
    one(
        "a seed too large to be kept",
        "test_a_seed_that_is_none_is_refused",
        "if not 0 <= number < SEED_LIMIT:",
        "if not 0 <= number <= SEED_LIMIT:",
    ),
    one(
        "other random numbers gone on with",
        "test_other_random_numbers_are_refused",
        "if origin.stream_version != STREAM_VERSION: yield",
        "if False:\n    yield",
    ),
)
