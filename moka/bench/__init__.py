"""Measurements: pictures compared, times, errors against truth."""
