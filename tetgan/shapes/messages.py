"""Messages between repair and its child process: a length, then an .npz of plain arrays."""

import io
import struct
from typing import IO

import numpy as np

_LENGTH = struct.Struct("<Q")


def write_message(stream: IO[bytes], arrays: dict[str, np.ndarray]) -> None:
    """Send named arrays and flush."""
    buffer = io.BytesIO()
    np.savez(buffer, allow_pickle=False, **arrays)  # type: ignore[arg-type]
    stream.write(_LENGTH.pack(buffer.tell()))
    stream.write(buffer.getvalue())
    stream.flush()


def read_message(stream: IO[bytes]) -> dict[str, np.ndarray] | None:
    """The next message, or None where the stream ends, even in the middle of one."""
    header = stream.read(_LENGTH.size)
    if len(header) < _LENGTH.size:
        return None
    (length,) = _LENGTH.unpack(header)
    body = stream.read(length)
    if len(body) < length:
        return None
    with np.load(io.BytesIO(body), allow_pickle=False) as arrays:
        return dict(arrays)
