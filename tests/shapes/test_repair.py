"""Broken shapes become solids, by both methods."""

from collections.abc import Iterator

import numpy as np
import pytest
from soups import box, join, lathe, without_side
from test_cleaning import BROKEN, REASONS

from tetgan.geometry.triangles import TriangleMesh
from tetgan.shapes.cleaning import ShapeError
from tetgan.shapes.isolation import RepairWorker
from tetgan.shapes.options import RepairOptions
from tetgan.shapes.repair import check_solid, repair_shape

_OPTIONS = {
    "alpha_wrap": RepairOptions(method="alpha_wrap", alpha=0.06, offset=0.005),
    "manifold": RepairOptions(method="manifold", resolution=5000),
}
# Repair adds its offset on every side of a cube of side 1; manifold's is a leaf of its octree, about 1/25.
_GROWTH = {"alpha_wrap": 1.0101**3, "manifold": 1.09**3}


@pytest.fixture(scope="module", params=sorted(_OPTIONS))
def repairer(request) -> Iterator[tuple[RepairWorker, RepairOptions]]:
    options = _OPTIONS[request.param]
    with RepairWorker(options) as worker:
        yield worker, options


def _flip(soup: TriangleMesh, mask: np.ndarray) -> TriangleMesh:
    return TriangleMesh(soup.vertices, np.where(mask[:, None], soup.faces[:, ::-1], soup.faces))


def _flaws() -> dict[str, TriangleMesh]:
    cube = box()
    some = np.arange(12) % 3 == 0
    return {
        "closed": cube,
        "inside out": _flip(cube, np.ones(12, dtype=bool)),
        "some faces flipped": _flip(cube, some),
        "doubled": join(cube, _flip(cube, some)),
        "no shared corners": TriangleMesh(cube.triangles.reshape(-1, 3), np.arange(36).reshape(-1, 3)),
        "double walls": join(cube, box(size=(0.8, 0.8, 0.8))),
        "overlapping parts": join(
            box(size=(1, 1, 0.6), centre=(0, 0, -0.2)), box(size=(1, 1, 0.6), centre=(0, 0, 0.2))
        ),
    }


@pytest.mark.parametrize("name", sorted(_flaws()))
def test_a_flawed_cube_becomes_the_cube(repairer, name: str) -> None:
    worker, options = repairer
    repaired = repair_shape(_flaws()[name], worker, options)
    assert check_solid(repaired.solid) == repaired.volume
    assert 1 <= repaired.volume <= _GROWTH[options.method]
    assert (repaired.filled_share, repaired.hollow) == (0, False)
    assert repaired.distance <= (_GROWTH[options.method] ** (1 / 3) - 1)


def test_a_cube_without_its_floor_is_filled_and_says_so(repairer) -> None:
    worker, options = repairer
    repaired = repair_shape(without_side(box(), axis=1, side=0), worker, options)
    # The new floor is domed: it stands where a little more than half of what can be seen is walls.
    assert 0.85 < repaired.volume <= _GROWTH[options.method]
    assert repaired.filled_share > 0.5
    assert not repaired.hollow


def test_a_vase_of_one_sheet_is_filled_and_one_with_a_wall_is_not(repairer) -> None:
    worker, options = repairer
    belly = [(1e-6, 0.0), (0.3, 0.0), (0.45, 0.4), (0.2, 0.9), (0.2, 1.0)]
    sheet = repair_shape(lathe(belly), worker, options)
    wall = [(0.12, 1.0), (0.12, 0.9), (0.37, 0.4), (0.22, 0.08), (1e-6, 0.08)]
    walled = repair_shape(lathe([*belly, *wall]), worker, options)
    assert sheet.filled_share > 0.5
    assert walled.filled_share == 0
    assert walled.volume < 0.75 * sheet.volume


def test_filling_can_be_turned_off_and_the_hollow_is_still_reported() -> None:
    options = _OPTIONS["alpha_wrap"].model_copy(update={"fill_hollow": False})
    with RepairWorker(options) as worker:
        repaired = repair_shape(without_side(box(), axis=1, side=0), worker, options)
    assert repaired.hollow
    assert repaired.filled_share == 0
    assert repaired.volume < 0.2


@pytest.mark.parametrize("name", sorted(BROKEN))
def test_no_broken_shape_reaches_the_libraries(monkeypatch, name: str) -> None:
    monkeypatch.setattr(RepairWorker, "repair", lambda *_: pytest.fail("a broken shape got through"))
    with pytest.raises(ShapeError, match=REASONS[name]):
        repair_shape(BROKEN[name], RepairWorker(RepairOptions()), RepairOptions())


@pytest.mark.parametrize(
    ("returned", "reason"),
    [
        (without_side(box(), 1, 1), "not watertight"),
        (_flip(box(), np.arange(12) == 5), "not watertight"),
        (_flip(box(), np.ones(12, dtype=bool)), "no volume"),
        (TriangleMesh(np.full((8, 3), np.nan), box().faces), "no finite surface"),
        (TriangleMesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64)), "no finite surface"),
    ],
)
def test_what_comes_back_is_checked(returned: TriangleMesh, reason: str) -> None:
    with pytest.raises(ShapeError, match=reason):
        check_solid(returned)


def test_repair_is_deterministic(repairer) -> None:
    worker, options = repairer
    soup = join(box(), box(size=(0.3, 2, 0.3)))
    first, second = (repair_shape(soup, worker, options).solid for _ in range(2))
    np.testing.assert_array_equal(first.vertices, second.vertices)
    np.testing.assert_array_equal(first.faces, second.faces)
