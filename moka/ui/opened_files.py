"""The model and the environment that are open, and what becomes of them."""

import os
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from msgspec.structs import replace

from moka.core.errors import MokaError
from moka.core.resources import asset_folder, shader_folder
from moka.lighting.environment import Environment, load_environment
from moka.model import Model, load_model
from moka.scene.camera import Camera
from moka.scene.camera_choice import Look, Orbit, choose_camera, parse_camera
from moka.scene.drawables import ModelLayout
from moka.ui.file_watcher import FileWatcher
from moka.ui.light_preparation import (
    PreparedLight,
    adopt_light,
    prepare_light,
)
from moka.ui.preferences import Preferences, with_recent

if TYPE_CHECKING:
    from moka.renderer.geometry import Upload
    from moka.ui.viewer import Viewer

__all__ = ["OpenedFiles"]

MODEL_SUFFIXES = (".gltf", ".glb")
ENVIRONMENT_SUFFIXES = (".hdr", ".exr")

# What is done to what the renderer prepares.
_VERBS = {"images": "decoding", "meshes": "preparing"}


class OpenedFiles:
    """Reads files in the background, shows them, and reads them again.

    ``model_source`` and ``environment_source`` are what is open: a path, a
    built-in name, or what else was given. They are read anew when they
    change on disk, and so are the shaders.
    """

    def __init__(self, viewer: "Viewer") -> None:
        self._viewer = viewer
        self.model_source: Any = viewer.begun.source
        self.environment_source: Any = viewer.begun.environment
        self._watcher = FileWatcher(self._files_changed)
        self._changed: set[Path] = set()

    def close(self) -> None:
        """Watch nothing any more."""
        self._watcher.close()

    @property
    def remembered_environment(self) -> str:
        """How the environment is found again from any folder."""
        source = self.environment_source
        if not _is_path(source):
            return Preferences().environment
        path = Path(source)
        return str(path.absolute() if path.is_file() else source)

    def scene_of(self, source: Any) -> str | int | None:
        """Which scene of a model is shown: one was chosen for the first."""
        begun = self._viewer.begun
        return begun.scene if source is begun.source else None

    def open(self, path: str | os.PathLike[str]) -> None:
        """Open a model or an environment, as its ending says."""
        viewer = self._viewer
        suffix = Path(path).suffix.lower()
        if suffix in MODEL_SUFFIXES:
            self.open_model(path)
        elif suffix in ENVIRONMENT_SUFFIXES:
            self.open_environment(path)
        else:
            viewer.error = (
                f"{path}: neither a model ({', '.join(MODEL_SUFFIXES)}) nor "
                f"an environment ({', '.join(ENVIRONMENT_SUFFIXES)})"
            )
            viewer.request_redraw()

    def open_model(self, source: Any, *, keep_view: bool = False) -> None:
        """Read a model in the background, and show it in place of this one.

        ``keep_view`` leaves the camera where it is.
        """
        viewer = self._viewer
        viewer.work.start(
            f"reading {_name(source)}",
            partial(self._read_model, source),
            partial(self._show_model, source, keep_view=keep_view),
        )

    def _read_model(
        self, source: Any
    ) -> "tuple[Model, ModelLayout, list[Upload]]":
        """A model that is ready to be drawn; in the background."""
        viewer = self._viewer
        model = source
        if not isinstance(source, Model):
            path = asset_folder() / "demo.glb" if source is None else source
            model = load_model(path)
        # The scene finds the layout again as long as somebody holds it.
        variant = viewer.begun.variant if viewer.model is None else None
        layout = viewer.scene.layout_of(
            model,
            model.scene_index(self.scene_of(source)),
            model.variant_index(variant),
        )

        def told(what: str, done: int, total: int) -> None:
            viewer.work.tell(
                f"{_VERBS[what]} {what} of {_name(source)}: {done} of {total}"
            )

        uploads = viewer.renderer.prepare_geometry(layout.primitives, told)
        return model, layout, uploads

    def open_environment(self, source: Any) -> None:
        """Read an environment in the background, and light with it."""
        self._viewer.work.start(
            f"reading {_name(source)}",
            partial(self._read_environment, source),
            partial(self._show_environment, source),
        )

    def _read_environment(
        self, source: Any
    ) -> tuple[Environment | None, PreparedLight]:
        """An environment, and what lights with it; in the background."""
        viewer = self._viewer
        environment = source
        if source is not None and not isinstance(source, Environment):
            environment = load_environment(source)

        def told(progress: str) -> None:
            viewer.work.tell(
                f"preparing the light of {_name(source)}: {progress}"
            )

        prepared = prepare_light(
            viewer,
            environment,
            viewer.settings,
            viewer.comparison.choice,
            told,
        )
        return environment, prepared

    def _show_model(
        self,
        source: Any,
        read: "tuple[Model, ModelLayout, list[Upload]]",
        *,
        keep_view: bool,
    ) -> None:
        viewer = self._viewer
        model, _, uploads = read
        viewer.renderer.adopt_geometry(uploads)
        is_first = viewer.model is None
        viewer.remove_model()
        begun = viewer.begun
        viewer.model = viewer.scene.add(
            model,
            scene=self.scene_of(source),
            variant=begun.variant if is_first else None,
        )
        if viewer.model.model.animations:
            if is_first and (begun.time or begun.animation is not None):
                viewer.model.animations.pose(begun.animation or 0, begun.time)
            else:
                viewer.model.animations.play()
        self.model_source = source
        if _is_path(source):
            viewer.preferences = replace(
                viewer.preferences,
                recent_models=with_recent(
                    viewer.preferences.recent_models, source
                ),
            )
        viewer.selection = None
        viewer.error = None
        self._watch()
        viewer.viewpoint.forget_cameras()
        viewer.edits.clear()
        if viewer.window is not None:
            viewer.window.set_title(f"{_name(source)} - moka")
        if keep_view:
            return
        width, height = viewer.size
        choice = begun.camera if is_first else None
        if isinstance(choice, str):
            choice = parse_camera(choice)
        if isinstance(choice, Look):
            viewer.viewpoint.look_as(choice)
            return
        if isinstance(choice, Orbit) or (
            choice is None and not viewer.scene.cameras
        ):
            viewer.viewpoint.orbit(
                choice or Orbit(viewer.controls.yaw, viewer.controls.pitch)
            )
            return
        if not isinstance(choice, Camera):
            choice = choose_camera(viewer.scene, choice, width / height)
        viewer.viewpoint.look_through(choice)

    def _show_environment(
        self,
        source: Any,
        read: tuple[Environment | None, PreparedLight],
    ) -> None:
        viewer = self._viewer
        viewer.scene.environment, prepared = read
        adopt_light(prepared)
        self.environment_source = source
        if _is_path(source) and Path(source).exists():
            viewer.preferences = replace(
                viewer.preferences,
                recent_environments=with_recent(
                    viewer.preferences.recent_environments, source
                ),
            )
        viewer.error = None
        self._watch()
        viewer.request_redraw()

    def _watch(self) -> None:
        """Watch the shaders, and the files that are shown."""
        shown = [
            Path(source)
            for source in (self.model_source, self.environment_source)
            if isinstance(source, str | os.PathLike) and Path(source).exists()
        ]
        self._watcher.watch([shader_folder(), *shown])

    def _files_changed(self, paths: frozenset[Path]) -> None:
        """Note it; called on the thread of the watcher."""
        self._changed |= paths
        self._viewer.request_redraw()

    def reload(self) -> None:
        """Read what has changed again; what is broken stays as it was."""
        viewer = self._viewer
        changed, self._changed = self._changed, set()
        if not changed:
            return
        if any(path.is_relative_to(shader_folder()) for path in changed):
            try:
                viewer.renderer.reload_shaders()
                if viewer.comparison.renderer is not None:
                    viewer.comparison.renderer.reload_shaders()
                viewer.error = None
            except MokaError as error:
                viewer.error = str(error)
        if _is_among(self.model_source, changed):
            self.open_model(self.model_source, keep_view=True)
        if _is_among(self.environment_source, changed):
            self.open_environment(self.environment_source)


def _name(source: Any) -> str:
    if isinstance(source, str | os.PathLike):
        return Path(source).name
    return "the demo scene" if source is None else "a model"


def _is_path(source: Any) -> bool:
    return isinstance(source, str | os.PathLike)


def _is_among(source: Any, changed: set[Path]) -> bool:
    return _is_path(source) and Path(source).resolve() in changed
