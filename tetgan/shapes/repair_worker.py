"""Child process of repair and simplification, the only importer of the C++ repair libraries.

Run as `python -m tetgan.shapes.repair_worker OPTIONS_JSON`; meshes arrive on stdin and leave on stdout.
A crash or a hang of a library ends this process and nothing else. pymeshlab is GPL-3: it stays behind this
pipe.
"""

import os
import resource
import signal
import sys
from collections.abc import Callable
from typing import Annotated

import numpy as np
from jaxtyping import Float, Int
from pydantic import Field, TypeAdapter

from tetgan.shapes.messages import read_message, write_message
from tetgan.shapes.options import RepairOptions, SimplifyOptions

Arrays = tuple[Float[np.ndarray, "V 3"], Int[np.ndarray, "F 3"]]

_MEMORY_BYTES = 6 * 2**30  # address space; the libraries need well below 1 GiB on sane shapes


def manifold(
    vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"], options: RepairOptions
) -> Arrays:
    """Octree, then its outer boundary projected back to the input (Huang, Su & Guibas 2018)."""
    import point_cloud_utils as pcu  # noqa: PLC0415

    return pcu.make_mesh_watertight(vertices, faces, options.resolution)


def alpha_wrap(
    vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"], options: RepairOptions
) -> Arrays:
    """Shrink-wrap that enters no opening narrower than alpha (Portaneri et al. 2022)."""
    import pymeshlab  # noqa: PLC0415

    # Every face gets corners of its own: faces that share them in a way no manifold can (flipped, doubled,
    # three at an edge) are silently dropped on the way in, and the wrap then flows in through the hole.
    corners = vertices[faces].reshape(-1, 3)
    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.add_mesh(pymeshlab.Mesh(corners, np.arange(len(corners)).reshape(-1, 3)))
    meshes.generate_alpha_wrap(
        alpha=pymeshlab.PureValue(options.alpha), offset=pymeshlab.PureValue(options.offset)
    )
    wrapped = meshes.current_mesh()
    return wrapped.vertex_matrix(), wrapped.face_matrix()


def quadric_collapse(
    vertices: Float[np.ndarray, "V 3"], faces: Int[np.ndarray, "F 3"], options: SimplifyOptions
) -> Arrays:
    """Edges collapsed where that moves the surface least (Garland & Heckbert 1997), topology kept.

    A closed surface stays closed: no cleaning, for that joins vertices that have come to lie in one place,
    and a constraint on flat parts, where many of them would. A mesh with few enough faces comes back as it
    is.
    """
    if len(faces) <= options.faces:
        return vertices, faces
    import pymeshlab  # noqa: PLC0415

    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.add_mesh(pymeshlab.Mesh(vertices, faces))
    meshes.meshing_decimation_quadric_edge_collapse(
        targetfacenum=options.faces, preservetopology=True, planarquadric=True, autoclean=False
    )
    simplified = meshes.current_mesh()
    return simplified.vertex_matrix(), simplified.face_matrix()


METHODS: dict[str, Callable[..., Arrays]] = {
    "manifold": manifold,
    "alpha_wrap": alpha_wrap,
    "quadric_collapse": quadric_collapse,
}


def serve(repair: Callable[[np.ndarray, np.ndarray], Arrays], timeout_seconds: float) -> None:
    """Answer meshes by meshes; see `serve_requests`."""

    def answer(request: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        vertices, faces = repair(request["vertices"], request["faces"])
        return {"vertices": np.asarray(vertices, float), "faces": np.asarray(faces, np.int64)}

    serve_requests(answer, timeout_seconds)


def serve_requests(
    answer: Callable[[dict[str, np.ndarray]], dict[str, np.ndarray]],
    timeout_seconds: float,
    memory_bytes: int = _MEMORY_BYTES,
) -> None:
    """Answer requests until stdin closes; an exception becomes an answer with its text.

    A request that takes more than `timeout_seconds` of processor time ends the process by SIGPROF. Unlike
    wall time that does not depend on what else the machine does, so neither does which shapes are rejected.
    """
    resource.setrlimit(resource.RLIMIT_AS, (memory_bytes, memory_bytes))
    # The libraries print to stdout, which belongs to the answers: theirs goes to stderr.
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    while (request := read_message(sys.stdin.buffer)) is not None:
        signal.setitimer(signal.ITIMER_PROF, timeout_seconds)
        try:
            found = answer(request)
            signal.setitimer(signal.ITIMER_PROF, 0)
        except Exception as error:
            write_message(answers, {"error": np.array(f"{type(error).__name__}: {error}")})
        else:
            write_message(answers, found)


def main() -> None:
    """Serve the method that the options on the command line name."""
    options: RepairOptions | SimplifyOptions = TypeAdapter(
        Annotated[RepairOptions | SimplifyOptions, Field(discriminator="method")]
    ).validate_json(sys.argv[1])
    method = METHODS[options.method]
    serve(lambda vertices, faces: method(vertices, faces, options), options.timeout_seconds)


if __name__ == "__main__":
    main()
