"""Faults of what people meet: the command line, the figures, the pages, the paper's claims."""

from __future__ import annotations

from mutations.mutant import one

CLI = (
    one(
        "a disagreement with exit code 0",
        "test_a_run_outside_has_its_own_exit_code_and_a_line_that_names_what",
        "if found.outside: raise RunOutside(",
        "if False:\n    raise RunOutside(",
    ),
    one(
        "no JSON where a number is none",
        "test_json_stays_json_whatever_a_damaged_file_holds",
        "name: value if isfinite(value) else None for",
        "name: value for",
    ),
    one(
        "text that steers a terminal",
        "test_only_what_is_printed_meanwhile_is_escaped",
        'c if c.isprintable() or c == "\\n" else',
        'c if c.isprintable() or c in "\\n\\x1b" else',
    ),
    one(
        "--seed passed over",
        "test_the_seed_is_the_one_of_the_file_option_or_setting",
        "overrides(changes, seed=seed, engine=engine)",
        "overrides(changes, seed=None, engine=engine)",
    ),
    one(
        "hours told as minutes",
        "test_an_hour_is_told_as_such",
        "hours, minutes = divmod(minutes, 60)",
        "hours = 0",
    ),
)

FIGURES = (
    one(
        "a thinned curve without its peaks",
        "test_a_thinned_curve_keeps_its_extremes",
        "np.maximum.reduceat(value, starts)], axis=-1)",
        "np.minimum.reduceat(value, starts)], axis=-1)",
    ),
    one(
        "a thinned column without its peaks",
        "test_of_many_rows_the_extremes_are_kept",
        "np.maximum.reduceat(chunk, starts)], axis=-1)",
        "np.minimum.reduceat(chunk, starts)], axis=-1)",
    ),
    one(
        "lenses drawn too narrow",
        "test_the_lens_that_is_drawn_has_the_area_of_the_junction",
        "half = np.arccos(min(abs(shift) / (2.0 * radius), 1.0))",
        "half = np.arccos(min(abs(shift) / radius, 1.0))",
    ),
    one(
        "sums of bins drawn for means",
        "test_bins_of_a_spectrum_keep_its_integral",
        "np.add.reduceat(density, starts) / counts",
        "np.add.reduceat(density, starts)",
    ),
    one(
        "replicates with the error of one",
        "test_four_replicates_halve_the_error_of_one",
        "standard_errors(model).std / sqrt(len(variances))",
        "standard_errors(model).std",
    ),
)

CLAIMS = (
    one(
        "the error of a ratio from one side",
        "test_errors_of_differences_and_ratios_add_up",
        "sqrt((first.standard_error / first.value) ** 2 + (second.standard_error / second.value) ** 2)",
        "first.standard_error / first.value",
    ),
    one(
        "a claim verdict_if_agreed against the theory",
        "test_a_verdict_needs_simulation_and_theory_to_agree",
        "return verdict if all(quantity.agrees for quantity in quantities) else",
        "return verdict if any(quantity.agrees for quantity in (*quantities, *quantities)) or quantities else",
    ),
    one(
        "a verdict on what was not read",
        "test_what_was_not_read_has_no_verdict_and_says_what_is_missing",
        "_CARRIES_A_VERDICT = (Known.PROOF, Known.ORIGINAL)",
        "_CARRIES_A_VERDICT = tuple(Known)",
    ),
    one(
        "runs that no verdict looks at",
        "test_an_original_that_was_read_is_reproduced_or_contradicted_by_both_numbers",
        "and simulated[0] <= high and low <= simulated[1]",
        "and simulated[0] <= simulated[1]",
    ),
    one(
        "an exponent without its factor's logarithm",
        "test_an_exponent_has_the_error_of_both_its_points",
        "standard_error=found.standard_error / found.value / abs(log(factor)),",
        "standard_error=found.standard_error / found.value,",
    ),
    one(
        "a page of disagreeing numbers",
        "test_no_ledger_is_written_where_simulation_and_theory_disagree",
        "if claim.quantity is not None and not claim.quantity.agrees]",
        "if claim.quantity is None and claim.published is not None]",
    ),
)
PAGES = (
    one(
        "a bar that never ends",
        "test_lives_have_the_numbers_of_the_command",
        "birth[row] < s && s <= death[row] : birth[row] <= s && s < death[row]",
        "birth[row] < s && s <= death[row] : birth[row] <= s",
    ),
    one(
        "or read as and",
        "test_conditions_choose_the_rows_that_the_command_chooses",
        "(i) => parts.some((part) => part(i))",
        "(i) => parts.every((part) => part(i))",
    ),
    one(
        "the lowest of a cell told as its highest",
        "test_cells_of_a_longer_run_hold_its_extremes",
        "high.append(np.maximum.reduceat(values, starts))",
        "high.append(np.minimum.reduceat(values, starts))",
    ),
    one(
        "rows of a page a row too late",
        "test_a_page_of_a_stretch_holds_its_rows_and_the_extremes_of_all",
        "file.column(group, column.name, first, last))",
        "file.column(group, column.name, first + 1, last))",
    ),
)
