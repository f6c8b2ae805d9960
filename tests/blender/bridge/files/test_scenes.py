# SPDX-License-Identifier: GPL-3.0-or-later

"""Scenes with all that may be beside meshes, written by commands to every kind of file."""

import bodies
import bpy
import pytest
import scenes
from command_line import IMPORTERS, assert_fails, loaded, run
from gltf_trees import read_tree

LIGHT, CAMERA = "KHR_lights_punctual", "cameras"


def added(name, data=None, parent=None):
    made = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(made)
    made.parent = parent
    return made


def rigged(obj):
    """Gives an object an armature with one bone, which turns in an action."""
    armature = bpy.data.armatures.new("Rig")
    rig = added("Rig", armature)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    bone = armature.edit_bones.new("Bone")
    bone.tail = (0, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    group = obj.vertex_groups.new(name="Bone")
    group.add(range(len(obj.data.vertices)), 1.0, "REPLACE")
    obj.modifiers.new("Rig", "ARMATURE").object = rig
    obj.parent = rig
    pose = rig.pose.bones["Bone"]
    pose.rotation_mode = "XYZ"
    for frame, angle in ((1, 0.0), (20, 0.5)):
        pose.rotation_euler = (angle, 0, 0)
        pose.keyframe_insert("rotation_euler", frame=frame)
    bpy.context.scene.frame_set(1)


@pytest.fixture
def scene(tmp_path):
    """Saves a scene with two textured meshes, and all kinds of other objects."""
    picture = scenes.image("Paint", scenes.noise(16, 16))
    parent = added("Parent")
    parent.location = (3, 0, 0)
    for name in ("Child", "Skinned", "Below", "Hidden", "Unselectable"):
        made = scenes.cube(picture)
        made.name = name
        tree = made.active_material.node_tree
        shader = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
        color = next(node for node in tree.nodes if node.type == "TEX_IMAGE")
        tree.links.new(color.outputs[0], shader.inputs["Base Color"])
    objects = bpy.data.objects
    objects["Child"].parent = parent
    objects["Child"]["note"] = "kept"
    objects["Below"].parent = objects["Child"]
    rigged(objects["Skinned"])
    added("Lamp", bpy.data.lights.new("Lamp", "POINT"), parent)
    added("View", bpy.data.cameras.new("View"))
    collection = bpy.data.collections.new("Group")
    collection.objects.link(bodies.cube("Member", location=(0, 9, 0)))
    bpy.context.scene.collection.objects.unlink(objects["Member"])
    instance = added("Instance")
    instance.instance_type, instance.instance_collection = "COLLECTION", collection
    curve = bpy.data.curves.new("Line", "CURVE")
    curve.splines.new("POLY").points.add(1)
    added("Line", curve)
    added("Words", bpy.data.curves.new("Words", "FONT"))
    objects["Hidden"].hide_set(True)
    objects["Unselectable"].hide_select = True
    path = tmp_path / "scene.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(path))
    return path


def nodes_of(path):
    return {node["name"]: node for node in read_tree(path)["nodes"]}


@pytest.mark.parametrize("ending", [".glb", ".gltf"])
def test_a_baked_model_keeps_all_that_is_in_it(scene, tmp_path, ending):
    (tmp_path / "out").mkdir()
    target = tmp_path / "out" / f"model{ending}"
    result = run("bake", scene, "--all", "--output", target)
    assert result.returncode == 0, result.stderr
    assert "Baked 1 image into" in result.stdout
    tree, nodes = read_tree(target), nodes_of(target)
    assert {"Parent", "Child", "Below", "Skinned", "Rig", "Lamp", "View", "Instance"} <= set(nodes)
    assert {"Unselectable", "Member", "Words"} <= set(nodes)
    names = [node["name"] for node in tree["nodes"]]
    children = {names[number] for number in nodes["Parent"]["children"]}
    assert children == {"Child", "Lamp"}
    assert nodes["Child"]["extras"] == {"note": "kept"}
    assert "skin" in nodes["Skinned"]
    assert len(tree["animations"]) == 1
    assert len(tree[CAMERA]) == 1
    assert len(tree["extensions"][LIGHT]["lights"]) == 1


def test_a_model_that_was_baked_can_be_baked_again(scene, tmp_path):
    """The contents of a glTF scene survive an import and an export."""
    (tmp_path / "a").mkdir()
    (tmp_path / "b").mkdir()
    first, second = tmp_path / "a" / "model.glb", tmp_path / "b" / "model.glb"
    assert run("bake", scene, "--all", "--output", first).returncode == 0
    result = run("bake", first, "--all", "--output", second)
    assert result.returncode == 0, result.stderr
    before, after = read_tree(first), read_tree(second)
    assert set(nodes_of(first)) <= set(nodes_of(second))
    for key in ("meshes", "materials", "animations", "skins", CAMERA):
        assert len(before[key]) == len(after[key]), key


def test_chosen_objects_include_their_armatures_and_parents(scene, tmp_path):
    target = tmp_path / "model.glb"
    result = run(
        *("bake", scene, "--all", "--output", target),
        *("--object", "Skinned", "--object", "Below", "--object", "Unselectable"),
    )
    assert result.returncode == 0, result.stderr
    nodes = nodes_of(target)
    assert set(nodes) == {"Skinned", "Rig", "Bone", "Below", "Unselectable"}
    assert "skin" in nodes["Skinned"]
    # The parents of another are not chosen; it stays where it was.
    assert nodes["Below"]["translation"] == pytest.approx([3, 0, 0])


@pytest.mark.parametrize("ending", [*IMPORTERS, ".blend"])
def test_results_in_every_kind_of_file(scene, tmp_path, ending):
    target = tmp_path / f"out{ending}"
    result = run("voxelize", scene, "-o", target, "--depth", 4)
    assert result.returncode == 0, result.stderr
    found = loaded(target)
    if ending in (".ply", ".stl"):
        assert len(found) == 1
    else:
        assert {"Child", "Below", "Skinned", "Unselectable"} <= set(found)
        assert ("Hidden" in found) == (ending == ".blend")
    low = min((obj.matrix_world @ v.co).x for obj in found.values() for v in obj.data.vertices)
    assert low == pytest.approx(-1.0, abs=0.3)


@pytest.mark.parametrize("ending", [".obj", ".glb", ".fbx"])
def test_boolean_results_in_every_kind_of_file(scene, tmp_path, ending):
    target = tmp_path / f"out{ending}"
    words = ("--object", "Child", "--object", "Below", "--operation", "union", "--depth", 4)
    result = run("boolean", scene, *words, "--output", target)
    assert result.returncode == 0, result.stderr
    assert "Child" in loaded(target)


def test_a_missing_exporter_is_reported_first(scene, tmp_path, monkeypatch, addon):
    files = addon("bridge.files.scenes")
    absent = files.Exporter("export_scene.nothing", "use_selection")
    monkeypatch.setitem(files.EXPORTERS, ".fbx", absent)
    monkeypatch.setitem(files.EXPORTERS, ".glb", absent)
    voxelize = ("voxelize", scene, "-o", tmp_path / "out.fbx", "--depth", 4)
    bake = ("bake", scene, "--all", "--output", tmp_path / "out.glb")
    for command in (voxelize, bake):
        result = run(*command)
        assert_fails(result, "this Blender has no exporter for ", "enable its add-on")
        assert "%" not in result.stderr
