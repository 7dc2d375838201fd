"""The panels of the viewer, one a file."""
