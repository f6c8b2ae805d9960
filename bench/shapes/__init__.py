"""Shapes to images: time, memory and error beside other rasterizers."""
