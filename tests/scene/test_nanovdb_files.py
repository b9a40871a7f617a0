"""Invariant: a NanoVDB file is the grid it describes, where it puts it; whatever is wrong with it is named."""

import contextlib
import sys

import numpy as np
import pytest
from nanovdb_writer import nanovdb_bytes

from fogproof import read_voxel_grid
from fogproof.analytic import coefficients
from fogproof.errors import FogproofError, InvalidInputError, UnsupportedError
from fogproof.scene import TransformedMedium, VoxelGrid

SPARSE = {(-3, 0, 1): 0.5, (4, 2, 1): 1.5, (9, 130, -140): 2.5, (0, 0, 0): 0.25}
HALF = np.diag([0.5, 0.25, 2.0])
TURN = np.array([[0.0, -0.5, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, 0.5]])


def written(tmp_path, **more):
    path = tmp_path / "smoke.nvdb"
    path.write_bytes(nanovdb_bytes(SPARSE, more.pop("matrix", HALF), (1.0, 2.0, 3.0), **more))
    return path


@pytest.mark.parametrize("codec", [0, 1], ids=["plain", "zip"])
def test_values_stand_where_they_are(tmp_path, codec):
    grid = read_voxel_grid(written(tmp_path, codec=codec, background=0.125), scale=2.0, interpolation="nearest")
    assert isinstance(grid, VoxelGrid)
    assert grid.sigma_t.shape == (13, 131, 142)
    for (i, j, k), value in SPARSE.items():
        assert grid.sigma_t[i + 3, j, k + 140] == 2 * value
        assert coefficients(grid, HALF @ (i, j, k) + (1, 2, 3), (0, 0, 1)).sigma_t == 2 * value
    assert np.sum(grid.sigma_t != 0.25) == len(SPARSE)
    assert grid.lower.tolist() == [1 - 0.5 * 3.5, 2 - 0.125, 3 - 2 * 140.5]


def test_tiles_fill_their_cubes(tmp_path):
    box = ((-4, -3, -30), (129, 130, 3))
    grid = read_voxel_grid(written(tmp_path, tiles=[((0, 0, -128), 7.0)], box=box))
    assert np.sum(grid.sigma_t == 7.0) == 128 * 128 * 30
    assert grid.sigma_t[4, 3, 0] == grid.sigma_t[131, 130, 29] == 7.0
    assert grid.sigma_t[132, 3, 29] == grid.sigma_t[131, 2, 29] == grid.sigma_t[131, 3, 30] == 0.0


def test_a_map_that_turns_is_a_transformed_medium(tmp_path):
    medium = read_voxel_grid(written(tmp_path, matrix=TURN), interpolation="nearest", albedo=0.5)
    assert isinstance(medium, TransformedMedium)
    for index, value in SPARSE.items():
        assert coefficients(medium, TURN @ index + (1, 2, 3), (0, 0, 1)).sigma_t == value


def test_a_grid_is_chosen_by_its_name(tmp_path):
    path = written(tmp_path)
    assert read_voxel_grid(path, name="density").sigma_t.max() == 2.5
    with pytest.raises(InvalidInputError, match="holds no grid 'heat', but \\['density'\\]"):
        read_voxel_grid(path, name="heat")


@pytest.mark.parametrize(
    ("more", "error", "said"),
    [
        ({"codec": 2}, UnsupportedError, "packed by Blosc"),
        ({"kind": 2}, UnsupportedError, "type 2"),
        ({"version": 30}, UnsupportedError, "version 30"),
        ({"box": ((0, 0, 0), (-1, 5, 5))}, InvalidInputError, "empty grid"),
        ({"box": ((0, 0, 0), (100000, 100000, 5))}, UnsupportedError, "more than"),
        (
            {"box": ((0, 0, 0), (499, 499, 499))},
            UnsupportedError,
            "almost all would be background; cut its bounding box",
        ),
        ({"matrix": np.zeros((3, 3))}, FogproofError, "must be invertible"),
    ],
)
def test_what_is_not_read_is_named(tmp_path, more, error, said):
    with pytest.raises(error, match=said):
        read_voxel_grid(written(tmp_path, **more))


def test_truncated_and_lying_files_are_named(tmp_path):
    path = written(tmp_path)
    whole = path.read_bytes()
    rng = np.random.default_rng(3)
    for length in [0, 4, 8, 15, 100, 190, 500, 800, 900, *rng.integers(900, len(whole) - 1, 2).tolist()]:
        path.write_bytes(whole[:length])
        with pytest.raises(InvalidInputError, match="NanoVDB"):
            read_voxel_grid(path)
    for at in [*range(8, 60, 7), *range(104, 128, 5), 336, 368, *range(200 + 672, 200 + 800, 19)]:
        broken = bytearray(whole)
        broken[at] ^= 0xFF
        path.write_bytes(bytes(broken))
        with contextlib.suppress(FogproofError):
            read_voxel_grid(path)


def test_openvdb_is_read_where_its_module_is(tmp_path, monkeypatch):
    path = tmp_path / "smoke.vdb"
    path.write_bytes(b"as OpenVDB likes it")
    for module in ("openvdb", "pyopenvdb"):
        monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(UnsupportedError, match="where 'openvdb' can be imported"):
        read_voxel_grid(path)
    monkeypatch.setitem(sys.modules, "openvdb", Module)
    grid = read_voxel_grid(path, scale=3.0)
    assert grid.sigma_t.tolist() == [[[0.0, 3.0]]]
    assert grid.lower.tolist() == [9.0, 19.0, 1.0]
    with pytest.raises(InvalidInputError, match="no such grid"):
        read_voxel_grid(path, name="heat")


class Module:
    """What is used of OpenVDB's module: a grid of two voxels of 2 m, at the indices (0, 0, -4) and (0, 0, -3)."""

    name = "density"

    @classmethod
    def readAllGridMetadata(cls, path):  # noqa: N802
        return [cls]

    @classmethod
    def read(cls, path, name):
        if name != "density":
            raise KeyError("no such grid")
        return cls

    @staticmethod
    def evalActiveVoxelBoundingBox():  # noqa: N802
        return (0, 0, -4), (0, 0, -3)

    @staticmethod
    def copyToArray(array, ijk):  # noqa: N802
        assert ijk == (0, 0, -4)
        array[0, 0, 1] = 1.0

    class transform:  # noqa: N801
        @staticmethod
        def indexToWorld(index):  # noqa: N802
            return tuple(2.0 * np.array(index) + (10, 20, 10))
