"""Seeds that are not chosen: the hash of what is tested, so that a lucky seed cannot be picked by hand.

RUBNOISE_TEST_SALT=anything gives every statistical test another seed; tools/verify_long.py does so on purpose.
"""

import hashlib
import os

SALT = os.environ.get("RUBNOISE_TEST_SALT", "")


def seed_of(name: str) -> int:
    """Return the seed that belongs to a name."""
    return int.from_bytes(hashlib.sha256(f"{name}/{SALT}".encode()).digest()[:6], "big")
