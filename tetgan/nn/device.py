"""Which device a name stands for, and the name of a device."""

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
    """What provenance calls it: the GPU's own name, or `cpu`."""
    return torch.cuda.get_device_name(device) if device.type == "cuda" else device.type
