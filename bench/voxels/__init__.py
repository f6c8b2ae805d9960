"""Meshes to voxels, and voxels to meshes."""
