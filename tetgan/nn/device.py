"""Devices by name, and the memory allocator."""

import ctypes
import sys

import torch

from tetgan.errors import UserError


def pick_device(name: str) -> torch.device:
    """The device of 'auto', 'cpu' or 'cuda'; auto is CUDA where there is one.

    Raises:
        UserError: CUDA is asked for and missing.
    """
    if name == "auto":
        return torch.device("cuda" if torch.cuda.is_available() else "cpu")
    if name == "cuda" and not torch.cuda.is_available():
        raise UserError("device 'cuda': this machine has no CUDA device; use 'auto' or 'cpu'")
    return torch.device(name)


def device_name(device: torch.device) -> str:
    """Name of a device for provenance: the GPU's own, or `cpu`."""
    return torch.cuda.get_device_name(device) if device.type == "cuda" else device.type


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
