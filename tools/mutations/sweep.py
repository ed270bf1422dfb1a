"""Faults of sweeps: what is handed out, tried again, written down as done, and found again."""

from __future__ import annotations

from mutations.mutant import one

MUTANTS = (
    one(
        "changed lines of a journal believed",
        "test_a_changed_byte_is_noticed[0]",
        "return len(digest) == _DIGITS and digest == xxhash.xxh3_64_hexdigest(text).encode()",
        "return len(digest) == _DIGITS",
    ),
    one(
        "a killed worker's point given up",
        "test_a_point_whose_worker_is_killed_is_tried_once_more",
        "elif point.run_id in self._tried:",
        "elif True:",
    ),
    one(
        "shards that overlap",
        "test_shards_are_parts_of_the_whole_whatever_the_order",
        "sorted(names)[self.number - 1 :: self.count]",
        "sorted(names)[self.number - 1 :]",
    ),
    one(
        "results taken as done without their hashes",
        "test_a_result_with_a_flipped_bit_is_not_taken_for_the_run",
        "or not file.summary or file.damaged() else",
        "or not file.summary else",
    ),
    one(
        "runs written down before the disk has them",
        "test_runs_wait_for_the_disk_together_and_are_written_down_then",
        "if synced: self._journal.add(",
        "if True:\n    self._journal.add(",
    ),
    one(
        "workers with a thread for each processor",
        "test_workers_are_told_to_use_one_thread",
        "env=os.environ | THREADS,",
        "env=dict(os.environ),",
    ),
    one(
        "the scatter of runs for the error of their mean",
        "test_what_is_reached_is_the_relative_standard_error_of_the_mean",
        "/ (len(finite) * (len(finite) - 1)))",
        "/ (len(finite) - 1))",
    ),
    one(
        "failed runs that count as met",
        "test_failed_runs_count_and_have_no_figure",
        "nan if precision is None else figures.get(precision.quantity, nan)",
        "nan if precision is None else figures.get(precision.quantity, 0.0)",
    ),
    one(
        "a worker stopped in its first call waits for another",
        "test_a_worker_that_is_stopped_in_its_first_call_leaves_by_itself",
        "gc.enable() while go_on:",
        "gc.enable()\ngo_on = True\nwhile go_on:",
    ),
)
