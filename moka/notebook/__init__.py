"""Live pictures in a Jupyter notebook: the extra ``moka-pbr[notebook]``."""

from moka.notebook.viewer import Viewer

__all__ = ["Viewer"]
