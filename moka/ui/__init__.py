"""Panels and the viewer: what a person sees around the picture."""
