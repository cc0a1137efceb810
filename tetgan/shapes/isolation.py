"""Child process that may crash or hang, replaced when it does."""

import contextlib
import os
import select
import signal
import subprocess
import sys
from collections.abc import Sequence
from types import TracebackType
from typing import ClassVar, Protocol, TypeVar, runtime_checkable

import numpy as np

from tetgan.geometry.triangles import TriangleMesh
from tetgan.shapes.cleaning import ShapeError
from tetgan.shapes.messages import read_message, write_message

# The child watches its own processor time; one that sleeps is waited for this long, on a busy machine too.
_START_SECONDS = 60.0

_PATIENCE = 20.0  # wall seconds a processor second


@runtime_checkable
class TimedOptions(Protocol):
    """Options that say for how long the child may work on a mesh."""

    @property
    def timeout_seconds(self) -> float: ...

    def model_dump_json(self) -> str: ...


Worker = TypeVar("Worker", bound="MeshWorker")


class MeshWorker:
    """Passes meshes through a child process, which lives on from mesh to mesh.

    Starting the child costs more than most meshes, so it is kept until one crashes it or takes more than
    `options.timeout_seconds` of processor time; the next mesh gets a new one. Use as a context manager.

    `program` is for tests; by default it is the class's own module, run with the options as JSON.
    """

    task: ClassVar[str]
    module: ClassVar[str] = "tetgan.shapes.repair_worker"

    def __init__(self, options: TimedOptions, program: Sequence[str] | None = None) -> None:
        default = (sys.executable, "-m", self.module, options.model_dump_json())
        self._program = tuple(program or default)
        self._timeout = options.timeout_seconds
        self._patience = _START_SECONDS + _PATIENCE * options.timeout_seconds
        self._process: subprocess.Popen[bytes] | None = None

    def __enter__(self: Worker) -> Worker:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """End the child."""
        if self._process is None:
            return
        process, self._process = self._process, None
        process.kill()
        for stream in (process.stdin, process.stdout):
            assert stream is not None
            with contextlib.suppress(BrokenPipeError):  # a request that the dead child never read
                stream.close()
        process.wait()

    def _send(self, soup: TriangleMesh) -> TriangleMesh:
        """One mesh through the child, and what it makes of it; see `_exchange`."""
        answer = self._exchange({"vertices": soup.vertices, "faces": soup.faces})
        return TriangleMesh(answer["vertices"].reshape(-1, 3), answer["faces"].reshape(-1, 3))

    def _exchange(self, request: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
        """Named arrays through the child, and those of its answer.

        Raises:
            ShapeError: the child raised, crashed, or took too long.
        """
        process = self._running()
        assert process.stdin is not None and process.stdout is not None
        try:
            write_message(process.stdin, request)
        except BrokenPipeError:
            raise ShapeError(self._obituary()) from None
        ready, _, _ = select.select([process.stdout], [], [], self._patience)
        if not ready:
            self.close()
            raise ShapeError(f"{self.task} hangs")
        answer = read_message(process.stdout)
        if answer is None:
            raise ShapeError(self._obituary())
        if "error" in answer:
            raise ShapeError(f"{self.task} failed: {answer['error']}")
        return answer

    def _running(self) -> subprocess.Popen[bytes]:
        if self._process is None:
            # Shards are the unit of parallel work, so a child keeps to one core.
            environment = os.environ | {"OMP_NUM_THREADS": "1"}
            self._process = subprocess.Popen(
                self._program, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=environment
            )
        return self._process

    def _obituary(self) -> str:
        """The reason why the child ended, once its pipe has closed."""
        assert self._process is not None
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(timeout=10)  # else the kill below would be its exit status
        status = self._process.poll()
        self.close()
        if status == -signal.SIGPROF:
            return f"{self.task} took longer than {self._timeout:g} s"
        return f"{self.task} crashed (exit status {status})"


class RepairWorker(MeshWorker):
    """Turns soups into solids."""

    task = "repair"

    def repair(self, soup: TriangleMesh) -> TriangleMesh:
        """One mesh through the child.

        Raises:
            ShapeError: the child raised, crashed, or took too long.
        """
        return self._send(soup)


class SimplifyWorker(MeshWorker):
    """Takes faces away from meshes."""

    task = "simplification"

    def simplify(self, soup: TriangleMesh) -> TriangleMesh:
        """One mesh through the child; one that has few enough faces stays as it is.

        Raises:
            ShapeError: the child raised, crashed, or took too long.
        """
        return self._send(soup)
