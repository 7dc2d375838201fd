"""Turns a scene into passes and packets; knows the frame's order."""
