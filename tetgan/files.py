"""Files and folders written whole or not at all."""

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tetgan.errors import UserError


def check_suffix(path: str | Path, what: str, *suffixes: str) -> None:
    """Say in which formats a thing is written, before it is made.

    Raises:
        UserError: the path has another suffix.
    """
    if Path(path).suffix.lower() not in suffixes:
        raise UserError(f"{path}: {what} is written as {' or '.join(suffixes)}; change the suffix")


@contextmanager
def whole_file(path: str | Path) -> Iterator[Path]:
    """Write to the yielded temporary name; `path` appears only when the block ends without an error.

    The temporary name is in the same folder, so the rename is atomic, and keeps the suffix, so that
    writers which choose a format by suffix still work. Errors of the system name `path`.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f".{os.getpid()}.partial.{path.name}")
    try:
        yield partial
        partial.replace(path)
    except OSError as error:
        if str(error.filename) == str(partial):
            error.filename = str(path)
        raise
    finally:
        partial.unlink(missing_ok=True)


@contextmanager
def whole_folder(path: str | Path, mark: str) -> Iterator[Path]:
    """The same for a folder: it replaces an older one only when the block ends without an error.

    Args:
        mark: pattern of a file that every such folder holds. A folder without one is somebody's own.

    Raises:
        UserError: `path` is a folder with other things in it.
    """
    path = Path(path)
    if path.is_dir() and any(path.iterdir()) and not any(path.glob(mark)):
        raise UserError(f"{path}: holds other things, which would be lost; name another folder")
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f".{os.getpid()}.partial.{path.name}")
    shutil.rmtree(partial, ignore_errors=True)
    partial.mkdir()
    try:
        yield partial
        shutil.rmtree(path, ignore_errors=True)
        partial.replace(path)
    finally:
        shutil.rmtree(partial, ignore_errors=True)
