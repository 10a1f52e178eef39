"""Digests of files, and files that end with their own checksum."""

from __future__ import annotations

import hashlib
import os
import stat
from pathlib import Path

from trackroller.files import open_here, sha256


def ends_with_checksum(path: Path) -> bool:
    """Return whether the last 32 bytes of a file are the SHA-256 of the bytes before them."""
    with open_here(path, "rb") as stream:
        return sums_up(stream.read())


def sums_up(content: bytes) -> bool:
    """Return whether the last 32 bytes of a content are the SHA-256 of the bytes before them."""
    return hashlib.sha256(content[:-32]).digest() == content[-32:]


def digest_of_file(path: Path) -> str:
    """Return the digest of a regular file, '' for anything else."""
    try:
        if stat.S_ISREG(os.lstat(path).st_mode):
            return sha256(path)
        return ""
    except OSError:
        return ""


def digest_of_text(text: str) -> str:
    """Return the digest of a text as it is written to a file."""
    return hashlib.sha256(text.encode()).hexdigest()
