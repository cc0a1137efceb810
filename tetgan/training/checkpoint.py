"""Checkpoints of a run: written whole, and resumed only by the run they belong to."""

import hashlib
import json
import logging
from pathlib import Path
from typing import Any

import torch

from tetgan.files import whole_file

log = logging.getLogger(__name__)

FILE = "checkpoint.pt"


def run_digest(**parts: Any) -> str:
    """SHA-256 of everything that makes a run what it is."""
    return hashlib.sha256(json.dumps(parts, sort_keys=True).encode()).hexdigest()


def save_checkpoint(folder: Path, digests: dict[str, str], state: dict[str, Any]) -> None:
    """Replace the checkpoint of `folder`; a kill at any moment leaves the old one or the new one."""
    with whole_file(folder / FILE) as partial:
        torch.save({"digests": digests} | state, partial)


def load_checkpoint(folder: Path, digests: dict[str, str]) -> dict[str, Any] | None:
    """The state to resume from, or None, with a line in the log that says why, where there is none."""
    path = folder / FILE
    if not path.is_file():
        return None
    try:
        state = torch.load(path, map_location="cpu", weights_only=True)
        found = state["digests"]
    except Exception as error:  # damage shows as any of a dozen kinds
        log.warning("%s: cannot be read (%s); training starts afresh", path, error)
        return None
    other = [name for name, digest in digests.items() if found.get(name) != digest]
    if other:
        log.warning("%s: of a run with other %s; training starts afresh", path, " and ".join(other))
        return None
    if state["finished"]:
        log.info("%s: that run is finished; training starts afresh", path)
        return None
    return state
