"""Pure data: handles, descriptors, sort keys and the command list; no GL."""
