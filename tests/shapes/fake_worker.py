"""A child process of repair that misbehaves on demand, by the first coordinate of the mesh."""

import ctypes
import os
import sys
import time

import numpy as np

from tetgan.shapes.repair_worker import serve


def repair(vertices: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    order = vertices[0, 0]
    if order == 1:
        ctypes.string_at(0)
    if order == 2:
        while True:
            pass
    if order == 3:
        time.sleep(1000)
    if order == 4:
        raise ValueError("no such luck")
    if order == 5:
        os._exit(7)
    if order == 6:
        print("chatter on the answers' channel", flush=True)
        os.write(1, b"and below Python")
    if order == 7:
        np.zeros(2**40)
    return vertices, faces


serve(repair, timeout_seconds=float(sys.argv[1]))
