"""Executes recordings: the protocol, ModernGL, and one on paper."""
