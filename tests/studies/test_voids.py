import numpy as np
import trimesh

from tetgan.studies.voids import count_voids


def joined(*parts: trimesh.Trimesh) -> int:
    mesh = trimesh.util.concatenate(parts)
    return count_voids(np.array(mesh.vertices), np.array(mesh.faces, dtype=np.int64))


def test_hollows_are_counted_and_islands_are_not():
    outer, hollow = trimesh.creation.box(), trimesh.creation.box((0.2, 0.2, 0.2))
    hollow.invert()
    island = trimesh.creation.box(bounds=[[2, 2, 2], [3, 3, 3]])
    another = hollow.copy()
    another.apply_translation([0.3, 0, 0])
    assert joined(outer) == 0
    assert joined(outer, island) == 0
    assert joined(outer, hollow) == 1
    assert joined(outer, hollow, another, island) == 2
    assert count_voids(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64)) == 0
