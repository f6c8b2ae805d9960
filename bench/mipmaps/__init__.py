"""Textures and the levels that are made of them."""
