"""A sweep with all of its results put into one file."""

from pathlib import Path

from rubnoise.storage.index_file import open_index
from rubnoise.storage.merging import write_merged
from rubnoise.storage.whole import whole_file
from rubnoise.sweep.folder import SweepFolder


def merge(folder: SweepFolder) -> Path:
    """Write the index of a folder and every result of it, by value, into merged.h5, and return its path.

    An older one is replaced. Raises RunFileRefused where there is no index or a result cannot be read, RubnoiseError
    where the disk fails.
    """
    with open_index(folder.index), whole_file(folder.merged, force=True) as path:
        write_merged(path, folder.index)
    return folder.merged
