"""Faults of files: what is flushed, locked, hashed, checked and taken up again."""

from __future__ import annotations

from mutations.mutant import one

MUTANTS = (
    one(
        "torn journal records believed",
        "test_a_changed_bit_ends_the_journal_before_its_record",
        "if len(content) != length or _checksum(kind, content) != checksum:",
        "if len(content) != length:",
    ),
    one(
        "rows committed before the disk has them",
        "test_a_commit_is_written_down_when_the_disk_has_its_rows",
        "disk.sync_rows(self.descriptor) self.sync_growing()",
        "self.sync_growing()",
    ),
    one(
        "growing rows committed before the disk has them",
        "test_a_commit_is_written_down_when_the_disk_has_its_growing_rows",
        "if self._growing is not None: self._growing.sync()",
        "return",
    ),
    one(
        "growing rows left beside a whole result",
        "test_rows_that_grow_end_in_the_file",
        "disk.remove(self.growing) disk.remove(self.journal)",
        "disk.remove(self.journal)",
    ),
    one(
        "a lock that two may hold",
        "test_a_second_writer_is_refused_and_the_first_goes_on",
        "with suppress(BlockingIOError): return fcntl.flock(descriptor, how | fcntl.LOCK_NB)",
        "with suppress(BlockingIOError):\n    return fcntl.flock(descriptor, fcntl.LOCK_SH | fcntl.LOCK_NB)",
    ),
    one(
        "a result replaced without being asked",
        "test_an_existing_file_is_refused_and_replaced_by_force",
        "if _mode(paths.final) is not None: raise OutputRefused(",
        "if False:\n    raise OutputRefused(",
    ),
    one(
        "a file of another's replaced at the end",
        "test_a_file_that_appears_during_the_run_is_spared",
        "if _mode(paths.final) is not None: raise OutputAppearedError(",
        "if False:\n    raise OutputAppearedError(",
    ),
    one(
        "a disk that is too small begun on",
        "test_a_compressed_run_needs_room_for_two_files",
        "if missing > free:",
        "if False:",
    ),
    one(
        "hashes that miss a replaced row",
        "test_a_row_replaced_is_in_every_later_mark",
        "self.flush() self._hash = None self._write(",
        "self.flush()\nself._write(",
    ),
    one(
        "short writes taken for whole ones",
        "test_short_writes_are_continued",
        "while data: written = _some(os.pwrite(",
        "if data:\n    written = _some(os.pwrite(",
    ),
    one(
        "links out of the file followed",
        "test_a_column_that_is_not_as_the_schema_says_is_refused",
        "and bool(owner.id.links.get_info(raw).type == h5py.h5l.TYPE_HARD)",
        "",
    ),
    one(
        "a later format read as this one",
        "test_a_later_format_names_the_version_needed",
        "version = _version(file) if version > FORMAT_VERSION:",
        "version = _version(file)\nif version > FORMAT_VERSION + 100:",
    ),
    one(
        "rows lost behind a commit overlooked",
        "test_rows_lost_behind_a_commit_send_it_back_to_an_earlier_one",
        "commits[min(fitting) - 1] if min(fitting) else None",
        "commits[max(fitting) - 1] if max(fitting) else None",
    ),
    one(
        "sound cut to whole steps",
        "test_samples_are_read_back_to_half_a_step",
        "np.rint(values * STEPS)",
        "np.trunc(values * STEPS)",
    ),
    one(
        "a force in N",
        "test_every_column_has_the_unit_of_its_quantity",
        'units="uN", symbol="F_s", long_name="friction force on the slider"),',
        'units="N", symbol="F_s", long_name="friction force on the slider"),',
    ),
)
