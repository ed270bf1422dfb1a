"""Faults of what is kept and gathered while rows pass by."""

from __future__ import annotations

from mutations.mutant import one

MUTANTS = (
    one(
        "panels merged without the distance of their means",
        "test_moments_do_not_depend_on_the_panels",
        "self.second += second + step**2 * share",
        "self.second += second",
    ),
    one(
        "rows forgotten where a record grows",
        "test_a_record_in_memory_grows",
        "room[name][: values.size] = values",
        "pass",
    ),
    one(
        "kurtosis not in excess",
        "test_the_merge_of_known_numbers",
        "self.fourth / self.count / self.variance**2 - 3.0",
        "self.fourth / self.count / self.variance**2",
    ),
)
