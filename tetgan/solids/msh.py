"""Gmsh's files, versions 2.2 and 4.1, binary: elements, and groups as physical groups."""

from collections.abc import Sequence
from pathlib import Path
from typing import BinaryIO, NamedTuple

import numpy as np
from jaxtyping import Bool, Int

from tetgan.solids.elements import Elements

VERSIONS = ("2.2", "4.1")

SOLID = "solid"
"""Physical group of all tets."""

_TETS = {1: 4, 2: 11}  # Gmsh's numbers of types of elements, by degree

_TRIANGLES = {1: 2, 2: 9}

_NODES = [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]  # Gmsh has the last two middles the other way round


class _Patch(NamedTuple):
    """Boundary faces that are in the same groups: a surface of the model, numbered from one.

    Attributes:
        groups: numbers of its physical groups.
        faces: (M, 3) or (M, 6) nodes.
    """

    groups: Sequence[int]
    faces: Int[np.ndarray, "M K"]


def write_msh(path: Path, elements: Elements, version: str) -> None:
    """Write the tets as the physical volume `solid`, and the faces of groups as physical surfaces.

    Version 4.1 lets a surface be in several physical groups, so every face is there once; in 2.2 it is there
    once for each of its groups.
    """
    cells = elements.cells if elements.order == 1 else elements.cells[:, _NODES]
    with path.open("wb") as file:
        _section(file, "MeshFormat", f"{version} 1 8\n".encode() + np.int32(1).tobytes() + b"\n")
        _section(file, "PhysicalNames", _names(list(elements.groups)))
        if version == "2.2":
            _write_22(file, elements, cells)
        else:
            _write_41(file, elements, cells, _patches(elements))


def _patches(elements: Elements) -> list[_Patch]:
    """Every face that is in a group, once."""
    if not elements.groups:
        return []
    member: Bool[np.ndarray, "F G"] = np.stack(list(elements.groups.values()), axis=1)
    kinds, kind = np.unique(member, axis=0, return_inverse=True)
    return [
        _Patch((1 + np.flatnonzero(of_kind)).tolist(), elements.faces[kind.ravel() == number])
        for number, of_kind in enumerate(kinds)
        if of_kind.any()
    ]


def _names(groups: Sequence[str]) -> bytes:
    lines = [f'2 {number} "{name}"' for number, name in enumerate(groups, 1)]
    lines.append(f'3 {len(groups) + 1} "{SOLID}"')
    return "\n".join([str(len(lines)), *lines, ""]).encode()


def _write_22(file: BinaryIO, elements: Elements, cells: Int[np.ndarray, "T K"]) -> None:
    nodes = np.empty(len(elements.nodes), [("tag", "<i4"), ("place", "<f8", 3)])
    nodes["tag"], nodes["place"] = 1 + np.arange(len(nodes)), elements.nodes
    _section(file, "Nodes", f"{len(nodes)}\n".encode() + nodes.tobytes() + b"\n")
    blocks = [
        (_TRIANGLES[elements.order], group, elements.faces[chosen])
        for group, chosen in enumerate(elements.groups.values(), 1)
    ]
    blocks.append((_TETS[elements.order], len(elements.groups) + 1, cells))
    body, count = b"", 0
    for kind, group, rows in blocks:
        tags = 1 + count + np.arange(len(rows))
        head = np.array([kind, len(rows), 2], dtype="<i4").tobytes()
        same = np.broadcast_to(group, (len(rows), 2))  # physical group, and an entity of its own
        body += head + np.column_stack([tags, same, 1 + rows]).astype("<i4").tobytes()
        count += len(rows)
    _section(file, "Elements", f"{count}\n".encode() + body + b"\n")


def _write_41(
    file: BinaryIO, elements: Elements, cells: Int[np.ndarray, "T K"], patches: Sequence[_Patch]
) -> None:
    nodes = elements.nodes
    entities = _longs(0, 0, len(patches), 1)
    for tag, patch in enumerate(patches, 1):
        entities += _entity(tag, nodes[patch.faces.ravel()], patch.groups, ())
    inside = nodes[cells.ravel()]
    entities += _entity(1, inside, [len(elements.groups) + 1], range(1, len(patches) + 1))
    _section(file, "Entities", entities + b"\n")
    count = len(nodes)
    tags = np.arange(1, count + 1, dtype="<u8").tobytes()
    head = _longs(1, count, 1, count) + _ints(3, 1, 0) + _longs(count)  # every node belongs to the volume
    _section(file, "Nodes", head + tags + nodes.astype("<f8").tobytes() + b"\n")
    blocks = [(2, tag, _TRIANGLES[elements.order], patch.faces) for tag, patch in enumerate(patches, 1)]
    blocks.append((3, 1, _TETS[elements.order], cells))
    total, first, body = sum(len(rows) for *_, rows in blocks), 1, b""
    for dimension, tag, kind, rows in blocks:
        numbered = np.column_stack([first + np.arange(len(rows)), 1 + rows]).astype("<u8")
        body += _ints(dimension, tag, kind) + _longs(len(rows)) + numbered.tobytes()
        first += len(rows)
    _section(file, "Elements", _longs(len(blocks), total, 1, total) + body + b"\n")


def _entity(tag: int, places: np.ndarray, groups: Sequence[int], bounds: Sequence[int]) -> bytes:
    """A surface or a volume: its box, its physical groups, and what bounds it."""
    box = np.concatenate([places.min(axis=0), places.max(axis=0)]).astype("<f8").tobytes()
    return _ints(tag) + box + _longs(len(groups)) + _ints(*groups) + _longs(len(bounds)) + _ints(*bounds)


def _ints(*values: int) -> bytes:
    return np.array(values, dtype="<i4").tobytes()


def _longs(*values: int) -> bytes:
    return np.array(values, dtype="<u8").tobytes()


def _section(file: BinaryIO, name: str, content: bytes) -> None:
    file.write(f"${name}\n".encode() + content + f"$End{name}\n".encode())
