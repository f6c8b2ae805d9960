"""Texture files for engines and viewers."""
