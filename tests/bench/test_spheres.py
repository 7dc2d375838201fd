"""The grid of spheres: what a facet is, and where it is in a picture."""

import numpy as np

from moka.bench.spheres import MATERIALS, SphereGrid

GRID = SphereGrid(MATERIALS[1:3], (0.0, 0.5, 1.0), 8)


def test_every_pixel_has_a_facet_with_the_normal_of_its_centre() -> None:
    scene = GRID.facets()
    primitive = scene.models[0].model.meshes[0].primitives[0]
    positions = primitive.attributes["POSITION"].reshape(-1, 4, 3)
    normals = primitive.attributes["NORMAL"].reshape(-1, 4, 3)
    centres = positions.mean(axis=1)
    # In the middle of pixels, whose corners are whole numbers.
    np.testing.assert_allclose(centres[:, :2] % 1, 0.5, atol=1e-6)
    np.testing.assert_allclose(normals[:, 0, :2], centres[:, :2] / 4)
    np.testing.assert_allclose(np.linalg.norm(normals, axis=-1), 1, rtol=1e-6)
    assert len(np.unique(centres, axis=0)) == len(centres) == 52
    # Narrower than a pixel: none reaches into its neighbours.
    width = np.ptp(positions[:, :, 0], axis=1)
    np.testing.assert_allclose(width, 1 - 1 / 32, rtol=1e-5)


def test_pixels_are_found_by_substance_and_roughness() -> None:
    width, height = GRID.size
    assert (width, height) == (24, 16)
    rows, columns = np.mgrid[:height, :width]
    picture = np.stack([rows, columns], axis=-1).astype(np.float32)
    pixels = GRID.pixels(picture)
    assert pixels.shape == (2, 3, 52, 2)
    for row in range(2):
        for column in range(3):
            y, x = pixels[row, column].T
            assert np.all((y >= 8 * row) & (y < 8 * row + 8))
            assert np.all((x >= 8 * column) & (x < 8 * column + 8))


def test_a_place_in_the_scene_is_that_in_the_picture() -> None:
    """The first substance is at the top, as in a table."""
    scene = GRID.smooth()
    scene.update()
    world = scene.drawables.world_bounds
    materials = [
        primitive.material.name for primitive in scene.drawables.primitives
    ]
    for name, (low, high) in zip(materials, world, strict=True):
        x, y, _ = (low + high) / 2
        assert name == (
            f"{GRID.substances[0 if y > 8 else 1].name} "
            f"{GRID.roughnesses[int(x // 8)]:g}"
        )
