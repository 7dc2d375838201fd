"""Pure data: handles, descriptors, sort keys and the command list; no GL.

Values here, and those of the rooms above that every render loads, are frozen
msgspec structs: defining one takes 10 µs where a frozen dataclass takes 450,
which would be a twentieth of a whole headless render.
"""
