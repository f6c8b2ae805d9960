"""Samples of mipmaps: throughput beside other samplers."""
