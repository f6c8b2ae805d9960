# SPDX-License-Identifier: GPL-3.0-or-later

"""Reports on voxelized objects."""

import importlib

import bpy

PACKAGE = "bl_ext.user_default.prefilter"


def outcome(*objects, **options):
    """Returns the outcome of voxelizing."""
    choices = importlib.import_module(f"{PACKAGE}.voxels.choices")
    voxelization = importlib.import_module(f"{PACKAGE}.voxels.voxelization")
    command = importlib.import_module(f"{PACKAGE}.core.command")
    settings = choices.VoxelizeSettings(**{"depth": 6, **options})
    depsgraph = bpy.context.evaluated_depsgraph_get()
    return command.run_work(voxelization.Voxelization.read(list(objects), settings, depsgraph))


def rows(line):
    """Returns the entries after the name of the object."""
    return line.split(": ", 1)[1].split("; ")


def the_line(found):
    (line,) = [one for one in [*found.warnings, *found.notes] if "parts: " in one]
    return rows(line)
