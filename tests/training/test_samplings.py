"""Learners receive the numbers that the stores hold."""

import numpy as np
import torch

from tetgan.training.data import PointData, VoxelData

CPU = torch.device("cpu")


def test_points_come_with_their_own_occupancy(points):
    data = PointData(points, "train")
    assert len(data) == 4
    batch = data.random(torch.tensor([2, 0]), 50, torch.Generator().manual_seed(0), CPU).numpy()
    for row, shape_id in zip(batch, [points.ids("train")[2], points.ids("train")[0]], strict=True):
        positions, inside = points.read(shape_id)
        places = [np.flatnonzero((positions == point).all(axis=1))[0] for point in row[:, :3]]
        np.testing.assert_array_equal(inside[places], row[:, 3] > 0.5)


def test_the_first_points_are_the_same_every_time(points):
    data = PointData(points, "validation")
    batch = data.first(torch.tensor([0]), 10, CPU)
    positions, inside = points.read("box-2")
    np.testing.assert_array_equal(batch[0, :, :3], positions[:10])
    np.testing.assert_array_equal(batch[0, :, 3], inside[:10])
    assert data.first(torch.tensor([0]), 10**6, CPU).shape == (1, len(positions), 4)


def test_voxels_are_in_units_of_the_clamp(voxels):
    data = VoxelData(voxels, "train")
    batch = data.batch(torch.tensor([3]), CPU)
    np.testing.assert_allclose(batch[0], voxels.read("box-1") / 0.1, atol=1e-3)
    assert batch.abs().max() == 1


def test_coarser_voxels_are_distances_at_their_centres(voxels):
    # Along x alone the distance to a wall is linear, and interpolation exact: (i + ½) / 8 and (j + ½) / 32.
    slope = np.broadcast_to(((np.arange(32) + 0.5) / 32 - 0.5)[:, None, None], (32, 32, 32)).astype(
        np.float32
    )
    data = VoxelData(voxels._replace(shapes={"box-0": 0.1 * slope}), "train")
    expected = (torch.arange(8) + 0.5) / 8 - 0.5
    got = data.batch(torch.tensor([0]), CPU, 8)
    torch.testing.assert_close(got[0], expected[:, None, None].expand(8, 8, 8), rtol=0, atol=1e-3)
