"""The modes of lighting that ``moka bench accuracy`` compares."""

from dataclasses import dataclass
from typing import Any

from msgspec.structs import replace

from moka.renderer.convergence import Schedule
from moka.renderer.quality import QUALITIES, settings_of_quality
from moka.renderer.settings import RenderSettings

__all__ = ["LightingMode", "lighting_modes", "truth_settings"]

# The settings that tell two choices of one mode apart.
_KNOBS = {
    "split-sum": ("ibl", "suns", "irradiance", "reflections"),
    "filtered": ("ibl", "suns", "irradiance", "reflections", "ibl_samples"),
    "reference": ("ibl", "reference_samples"),
}


@dataclass(frozen=True, slots=True)
class LightingMode:
    """A choice of lighting: what to call it, and all of its settings."""

    name: str
    settings: RenderSettings

    @property
    def family(self) -> str:
        """The mode without its knobs."""
        return self.settings.ibl

    @property
    def label(self) -> str:
        """What the name says besides the mode."""
        return self.name.removeprefix(self.family).lstrip(", ") or "auto"

    @property
    def samples(self) -> int:
        """Samples a pixel of reference lighting, 0 of other modes."""
        if self.family != "reference":
            return 0
        return self.settings.sample_budget

    @property
    def frames(self) -> int:
        """How many frames one picture takes."""
        return Schedule.of(self.samples).total_frames if self.samples else 1

    @property
    def knobs(self) -> dict[str, Any]:
        """The settings that the mode looks at."""
        return {
            name: getattr(self.settings, name) for name in _KNOBS[self.family]
        }

    @property
    def quality(self) -> str | None:
        """The named quality that this is, if any."""
        for name in QUALITIES:
            named = LightingMode(name, settings_of_quality(name))
            if named.knobs == self.knobs:
                return name
        return None


def lighting_modes(
    base: RenderSettings, *, quick: bool
) -> tuple[LightingMode, ...]:
    """The sweep: every mode, each knob at several values.

    ``base`` has the settings that all share; ``quick`` leaves out what tells
    least.
    """
    sweep: list[tuple[str, dict[str, object]]] = [
        ("split-sum, suns off", {"suns": "off"}),
        ("split-sum, half, sh", {"reflections": "half", "irradiance": "sh"}),
        ("split-sum, sh", {"irradiance": "sh"}),
        ("split-sum, cube", {"irradiance": "cube"}),
        ("split-sum", {}),
    ]
    if not quick:
        sweep += [
            ("split-sum, half", {"reflections": "half"}),
            ("split-sum, 1 sun", {"suns": 1}),
            (
                "filtered 16, half",
                {"ibl": "filtered", "reflections": "half"},
            ),
            ("filtered 16, suns off", {"ibl": "filtered", "suns": "off"}),
        ]
    sweep += [
        (f"filtered {count}", {"ibl": "filtered", "ibl_samples": count})
        for count in (4, 8, 16, 32)
    ]
    sweep += [
        (
            f"reference {count}",
            {"ibl": "reference", "reference_samples": count},
        )
        for count in ((16, 64, 256) if quick else (16, 64, 256, 1024))
    ]
    return tuple(
        LightingMode(name, replace(base, **knobs)) for name, knobs in sweep
    )


def truth_settings(base: RenderSettings, samples: int) -> RenderSettings:
    """Reference lighting with ``samples`` a pixel."""
    return replace(base, ibl="reference", reference_samples=samples)
