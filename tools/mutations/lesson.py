"""Faults of the page of lessons, which has the model once more in JavaScript, and of what is put into it."""

from __future__ import annotations

from mutations.mutant import one

MUTANTS = (
    one(
        "the page's area a power too low",
        "test_one_life_has_the_same_area",
        "return u > 0 ? diameter * diameter * u * Math.sqrt(u) * rising(u) : 0;",
        "return u > 0 ? diameter * u * Math.sqrt(u) * rising(u) : 0;",
    ),
    one(
        "the page's contact empty at the start",
        "test_a_start_is_stationary",
        "this.longest = 2 * this.contact.sizes.high;",
        "this.longest = 0;",
    ),
    one(
        "the page's gaps uniform",
        "test_gaps_are_exponential_and_sizes_normal",
        "return -Math.log(this.uniform());",
        "return 2 * this.uniform();",
    ),
    one(
        "the page's 0.327 a third",
        "test_numbers_are_those_of_the_package",
        "return Math.sqrt(wanted / 0.327);",
        "return Math.sqrt(3 * wanted);",
    ),
    one(
        "the page's moments of sizes miscounted",
        "test_numbers_are_those_of_the_package",
        "(n - 1) * this.std ** 2 * before",
        "n * this.std ** 2 * before",
    ),
    one(
        "the page's slider damped twice",
        "test_a_replayed_run_is_the_run",
        "const rate = damping / (2 * mass);",
        "const rate = damping / mass;",
    ),
    one(
        "the page told doubles the wrong way round",
        "test_a_replayed_run_is_the_run",
        'np.ascontiguousarray(values, dtype="<f8")',
        'np.ascontiguousarray(values, dtype=">f8")',
    ),
)
