"""Memory that torch frees stays with the process, so that the next step finds it ready."""

import ctypes
import sys

# glibc's mallopt, see malloc.h
_TRIM_THRESHOLD, _TOP_PAD, _MMAP_MAX = -1, -2, -4


def keep_freed_memory() -> None:
    """Let large tensors come from the heap, and the heap keep what is freed.

    By default glibc maps every tensor above 32 MB anew and hands it back when freed, so each step of a
    training loop has the kernel clear the same gigabytes page by page. Kept, a training step of PointNet++
    takes half the CPU time. The process holds its peak memory until it ends. Without glibc nothing happens.
    """
    if not sys.platform.startswith("linux"):
        return
    mallopt = getattr(ctypes.CDLL(None), "mallopt", None)
    if mallopt is None:
        return
    mallopt(_MMAP_MAX, 0)
    mallopt(_TRIM_THRESHOLD, 2**31 - 1)
    mallopt(_TOP_PAD, 64 * 2**20)
