"""Faults of reading: units, keys, layers of files, the points of a sweep."""

from __future__ import annotations

from mutations.mutant import one

MUTANTS = (
    one(
        "a GPa of a million MPa",
        "test_the_table_of_usual_units_is_equal_to_pint",
        '"GPa": "1e3"',
        '"GPa": "1e6"',
    ),
    one(
        "areas converted as lengths",
        "test_the_table_of_usual_units_is_equal_to_pint",
        '_LENGTHS, "^2", 2)',
        '_LENGTHS, "^2", 1)',
    ),
    one(
        "ticks counted in floats",
        "test_the_number_of_ticks_is_the_exact_floor_as_written",
        "return distance.exact // tick.exact",
        "return int(float(distance) // float(tick))",
    ),
    one(
        "critical damping without its 2",
        "test_a_damping_ratio_gives_the_damping",
        "critical = 2.0 * sqrt(stiffness * mass)",
        "critical = sqrt(stiffness * mass)",
    ),
    one(
        "a strength's spread in percent taken for MPa",
        "test_a_strength_law_has_its_mean_and_spread",
        "if spread.kind == RATIO:",
        "if not spread.kind:",
    ),
    one(
        "a default tick of a hundredth",
        "test_a_bare_scenario_has_the_defaults",
        "Fraction(repr(diameter / 100.0))",
        "Fraction(repr(diameter / 50.0))",
    ),
    one(
        "a base file on top of what extends it",
        "test_a_file_extends_another_deeply",
        "_merged(source.data for source in sources).items()",
        "_merged(source.data for source in reversed(sources)).items()",
    ),
    one(
        "tables replaced and not merged",
        "test_settings_go_on_top",
        "if not isinstance(below.get(key), dict):",
        "if True:",
    ),
    one(
        "numbers of any size allowed",
        "test_other_seeds_are_refused",
        "or self.low <= value <= self.high)",
        "or self.low <= value)",
    ),
    one(
        "unknown keys read over",
        "test_an_unknown_key_gets_a_suggestion",
        'extra="forbid"',
        'extra="ignore"',
    ),
    one(
        "only the first of values that go side by side",
        "test_a_zip_goes_side_by_side_within_the_grid",
        "yield (*firsts, *(row for _ in self.side_by_side))",
        "yield (*firsts, *(0 for _ in self.side_by_side))",
    ),
    one(
        "replicates of one seed",
        "test_seeds_and_names_are_all_different_and_in_range",
        "spawn_key=(*words, replicate)",
        "spawn_key=words",
    ),
)
