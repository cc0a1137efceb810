"""Child process of remeshing, with a time limit, since fTetWild may crash or take hours.

Run as `python -m tetgan.mechanics.remesh_worker OPTIONS_JSON`; surfaces come on stdin, tets go.
"""

import contextlib
import sys
import tempfile

import numpy as np
from jaxtyping import Float, Int

from tetgan.mechanics.options import RemeshOptions
from tetgan.shapes.repair_worker import serve


def tetrahedralise(
    vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"], options: RemeshOptions
) -> tuple[Float[np.ndarray, "W 3"], Int[np.ndarray, "T 4"]]:
    """Tets that fill a surface, by fTetWild on one core: the same each time."""
    import pytetwild  # noqa: PLC0415

    # It leaves a file of its own where it runs.
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        return pytetwild.tetrahedralize(
            vertices,
            faces.astype(np.int32),
            edge_length_fac=options.edge,
            epsilon=options.envelope,
            num_threads=1,
            quiet=True,
        )


def main() -> None:
    """Serve with the options on the command line."""
    options = RemeshOptions.model_validate_json(sys.argv[1])
    serve(lambda vertices, faces: tetrahedralise(vertices, faces, options), options.timeout_seconds)


if __name__ == "__main__":
    main()
