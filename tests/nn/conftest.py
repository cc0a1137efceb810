"""Run Triton's kernels in the interpreter where there is no GPU; set before Triton is imported."""

import os

import torch

if not torch.cuda.is_available():
    os.environ.setdefault("TRITON_INTERPRET", "1")
