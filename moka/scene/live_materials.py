"""Materials that animations or people change, as they are now."""

from collections.abc import Iterable

from moka.material.material import Material

__all__ = ["LiveMaterials"]


class LiveMaterials:
    """For materials of a scene's primitives what stands in for them now.

    Programs, textures and bind groups are those of the primitive's own
    material; only its numbers are others. ``version`` counts the changes.
    """

    def __init__(self) -> None:
        self.version = 0
        self._now: dict[Material, tuple[Material, int]] = {}

    def set(self, material: Material, now: Material) -> None:
        """Let ``material`` have the numbers of ``now``."""
        self.version += 1
        self._now[material] = now, self.version

    def now(self, material: Material) -> Material:
        """What stands in for ``material``, or itself."""
        return self._now.get(material, (material, 0))[0]

    def changed_since(self, version: int) -> list[tuple[Material, Material]]:
        """Materials that changed after ``version``, and what they are now."""
        return [
            (material, now)
            for material, (now, changed) in self._now.items()
            if changed > version
        ]

    def forget(self, materials: Iterable[Material]) -> None:
        """Leave out materials of a model that is gone."""
        for material in materials:
            self._now.pop(material, None)
