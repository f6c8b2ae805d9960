"""Oriented points to surfaces."""
