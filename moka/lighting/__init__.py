"""Environments, suns, and what is preintegrated of them."""
