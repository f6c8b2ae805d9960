# SPDX-License-Identifier: GPL-3.0-or-later

"""The images of a model, and their uses in shader nodes; reads no pixels."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import bpy

from ...bridge import derived, image_roles, images, level_images, materials, meshes, users
from ...bridge.image_roles import Role
from ...core.wording import listed

Shown = Mapping[bpy.types.Object, Sequence[bpy.types.Material]]
"""The materials of each object."""

_PART = "\0"
"""Separates the full name of an image from its part; names cannot contain it."""
_CHANNEL = {"red": " (red)", "green": " (green)", "blue": " (blue)", "alpha": " (alpha)"}


@dataclass(frozen=True)
class Item:
    """An image, and how to bake it. Data-blocks are stored by name, because an undo frees them.

    Attributes:
        image: Its name.
        full_name: The name, and the file that it is linked from.
        objects: The names of the objects whose surfaces are used.
        uses: The shader inputs that read it, such as "Base Color" and "Roughness (green)".
        content: A key of `choices.CONTENTS`; "cutout" is subject to a check of the pixels.
        threshold: The threshold of a cut-out's alpha test.
        tests_alpha: Whether that test reads the alpha channel instead of the color.
        channels: The channels that shaders read: "all", "red", "green", "blue", "alpha".
        normal_map: The key of the normal map that belongs to this roughness; empty for none.
        roughness_channel: The channel of the roughness, a key of `contents.CHANNELS`.
        is_alone: Whether it cannot be baked together with its normal map, because not all surfaces
            that show the normal map show it.
        notes: Remarks for the user.
        materials: The names of the materials that use it.
        part: "normal" if the item is only the image's role as a normal map, and another item has
            its other roles; otherwise empty.
    """

    image: str
    full_name: str
    objects: tuple[str, ...]
    uses: tuple[str, ...]
    content: str
    threshold: float = 0.5
    tests_alpha: bool = False
    channels: frozenset[str] = frozenset()
    normal_map: str = ""
    roughness_channel: str = "all"
    is_alone: bool = False
    notes: tuple[str, ...] = ()
    materials: frozenset[str] = frozenset()
    part: str = ""

    @property
    def key(self) -> str:
        """A key that is unique among all items."""
        return f"{self.full_name}{_PART}{self.part}" if self.part else self.full_name


@dataclass(frozen=True)
class Job:
    """The images of one bake.

    Attributes:
        item: The image.
        roughness: The roughness that is baked together with this normal map; None for none.
        normal_map: The key of the normal map to read for this roughness; empty for none.
    """

    item: Item
    roughness: Item | None = None
    normal_map: str = ""

    @property
    def images(self) -> list[str]:
        """The names of the images to bake."""
        return [item.image for item in (self.item, self.roughness) if item is not None]


@dataclass(frozen=True)
class LeftOut:
    """An image that is not baked, and why."""

    image: str
    reason: str


@dataclass(frozen=True)
class Plan:
    """The images of a model.

    Attributes:
        items: The images to bake, in the order of the objects that show them.
        left_out: The other images.
    """

    items: list[Item]
    left_out: list[LeftOut]

    def jobs(self) -> list[Job]:
        """Returns the bakes, one per image, or per normal map with its roughness."""
        partners: dict[str, Item] = {}
        for item in self.items:
            if item.normal_map and not item.is_alone:
                partners.setdefault(item.normal_map, item)
        return [
            Job(
                item,
                partners.get(item.key),
                "" if item.key in partners else item.normal_map,
            )
            for item in self.items
            if partners.get(item.normal_map) is not item
        ]


@dataclass
class _ImageUses:
    """The uses of an image in the scene."""

    objects: dict[str, None] = field(default_factory=dict)
    shown_by: dict[bpy.types.Material, None] = field(default_factory=dict)
    roles: dict[Role, None] = field(default_factory=dict)
    uses: dict[bpy.types.Material, frozenset[materials.ImageUse]] = field(default_factory=dict)
    problems: dict[str, None] = field(default_factory=dict)
    hidden: dict[str, None] = field(default_factory=dict)


def plan(
    view_layer: bpy.types.ViewLayer,
    depsgraph: bpy.types.Depsgraph,
    chosen: Iterable[bpy.types.Object] | None = None,
    *,
    material: str = "",
    by_role: bool = False,
) -> Plan:
    """Returns the images to bake.

    Args:
        view_layer: The view layer.
        depsgraph: Its evaluated dependency graph.
        chosen: The objects whose images are baked and whose surfaces are used; None for all visible
            objects. The content of an image depends on all visible objects.
        material: The name of the material whose images are baked; empty for all.
        by_role: Whether an image that is a normal map and has other roles gets two items.

    Raises:
        ValueError: There is no such material.
    """
    if material and material not in bpy.data.materials:
        raise ValueError(f"Material: there is no '{material}' in this file")
    shown = users.shown_materials(depsgraph)
    objects = dict.fromkeys(shown if chosen is None else chosen)
    for obj in objects:
        shown.setdefault(obj, meshes.materials_of_objects([obj]))
    found = _collect_uses(shown, objects)
    for obj in view_layer.objects:
        if obj not in shown and not obj.visible_get(view_layer=view_layer):
            for image in meshes.images_of_objects([obj]):
                found.setdefault(image, _ImageUses()).hidden[obj.name] = None
    partners = _partners(found)
    items: list[Item] = []
    left_out: list[LeftOut] = []
    for image, uses in found.items():
        if not uses.objects or not _has_material(uses, material):
            continue
        reason = _why_left_out(image, uses)
        if reason:
            left_out.append(LeftOut(image.name, reason))
        else:
            items += _items(image, uses, by_role=by_role)
    for rough, partner in partners.items():
        _pair(items, rough, partner, found)
    for image in bpy.data.images:
        uses = found.get(image, _ImageUses())
        if material or uses.objects or _is_internal(image):
            continue
        reason = "as no mesh shows it" if chosen is None else "as none of these objects shows it"
        if uses.hidden:
            reason = f"as only hidden objects show it, {listed(uses.hidden)}"
        left_out.append(LeftOut(image.name, reason))
    return Plan(items, left_out)


def describe_image(image: bpy.types.Image, shown_by: Iterable[bpy.types.Material]) -> Item:
    """Returns an image's item, based on some materials and no objects."""
    uses = _ImageUses()
    for material in shown_by:
        uses.shown_by[material] = None
        uses.roles.update(_roles(image, material))
    return _item(image, uses)


def image_of(key: str) -> bpy.types.Image:
    """Returns the image with a full name, or of an item's key.

    Raises:
        ValueError: It was deleted.
    """
    full_name = key.partition(_PART)[0]
    for image in bpy.data.images:
        if image.name_full == full_name:
            return image
    raise ValueError(f"image '{full_name}': is no longer there")


def _collect_uses(
    shown: Shown, objects: Mapping[bpy.types.Object, None]
) -> dict[bpy.types.Image, _ImageUses]:
    """Returns the uses of images in all materials, with those of the objects that show them."""
    found: dict[bpy.types.Image, _ImageUses] = {}
    images_of: dict[bpy.types.Material, list[bpy.types.Image]] = {}
    for obj, own_materials in shown.items():
        for material in own_materials:
            if material not in images_of:
                images_of[material] = materials.images_of(material)
                for image in images_of[material]:
                    _add(found.setdefault(image, _ImageUses()), image, material)
            if obj in objects:
                for image in images_of[material]:
                    found[image].objects[obj.name] = None
    return found


def _add(uses: _ImageUses, image: bpy.types.Image, material: bpy.types.Material) -> None:
    image_uses, problems = materials.image_uses(material, image)
    uses.shown_by[material] = None
    uses.uses[material] = frozenset(image_uses)
    uses.problems.update(dict.fromkeys(problems))
    uses.roles.update(_roles(image, material))


def _roles(image: bpy.types.Image, material: bpy.types.Material) -> dict[Role, None]:
    return {role: None for role in image_roles.roles(material) if role.image == image}


def _is_data(image: bpy.types.Image, uses: _ImageUses) -> bool:
    """Returns whether an image is only data; one that is also shown as a color is a color."""
    if not image.colorspace_settings.is_data:
        return False
    is_read_as_data = any(role.use == "data" and not role.is_factor for role in uses.roles)
    return not is_read_as_data or not any(
        image_roles.shows_as_color(material, image) for material in uses.shown_by
    )


def _why_left_out(image: bpy.types.Image, uses: _ImageUses) -> str:
    kind = images.kind_that_is_not_read(image)
    if kind is not None:
        return f"as it is {kind}; a still image is needed"
    if not any(uses.uses.values()):
        return f"as it has no UVs: {'; '.join(uses.problems)}"
    return ""


def _has_material(uses: _ImageUses, material: str) -> bool:
    return not material or any(user.name == material for user in uses.shown_by)


def _is_internal(image: bpy.types.Image) -> bool:
    """Returns whether an image was made by Blender or the add-on, such as a render result."""
    return (
        images.kind_that_is_not_read(image) in {"a render result", "a viewer image"}
        or level_images.is_level(image)
        or derived.source_of(image) is not None
    )


def _items(image: bpy.types.Image, uses: _ImageUses, *, by_role: bool) -> list[Item]:
    normal = {role: None for role in uses.roles if role.use == "normal"}
    others = {role: None for role in uses.roles if role.use != "normal"}
    if not (by_role and normal and others):
        return [_item(image, uses)]
    first = _item(image, replace(uses, roles=others))
    return [first, replace(_item(image, replace(uses, roles=normal)), part="normal")]


def _item(image: bpy.types.Image, uses: _ImageUses) -> Item:
    roles = [role for role in uses.roles if not role.is_factor]
    masks = [role for role in uses.roles if role.is_factor]
    labels = [f"{role.label}{_CHANNEL.get(role.channel, '')}" for role in roles]
    labels += [f"mask of {role.label}{_CHANNEL.get(role.channel, '')}" for role in masks]
    notes: list[str] = []
    item = Item(
        image.name,
        image.name_full,
        tuple(uses.objects),
        tuple(dict.fromkeys(labels)),
        "data" if _is_data(image, uses) else "color",
        channels=frozenset(role.channel for role in uses.roles),
        materials=frozenset(material.name for material in uses.shown_by),
    )
    tests = {
        round(role.threshold, 6): role.channel == "alpha"
        for role in roles
        if role.threshold is not None and 0.0 < role.threshold <= 1.0
    }
    if any(role.use == "normal" for role in roles):
        item = replace(item, content="normal")
        others = [use for use in item.uses if not use.startswith("Normal Map")]
        if others:
            notes.append(f"is filtered as a normal map, and read as {', '.join(others)} too")
    elif tests:
        threshold, tests_alpha = next(iter(tests.items()))
        item = replace(item, content="cutout", threshold=threshold, tests_alpha=tests_alpha)
        if len(tests) > 1:
            notes.append(
                f"is tested at {' and '.join(f'{test:g}' for test in sorted(tests))}; its cut-out "
                f"keeps the coverage at {threshold:g}"
            )
    if item.content == "color" and roles and not any(_may_be_color(role) for role in roles):
        notes.append(
            f"has the color space {image.colorspace_settings.name}, though shaders do not "
            f"read it as a color: {', '.join(item.uses)}; if its values are data, set "
            "Non-Color"
        )
    maps = {use.uv_map for image_uses in uses.uses.values() for use in image_uses}
    if len(maps) > 1:
        names = listed(name or "the active one" for name in sorted(maps))
        notes.append(f"is shown by several UV maps, which all count: {names}")
    if uses.hidden:
        notes.append(f"is shown by hidden objects too, which do not count: {listed(uses.hidden)}")
    return replace(item, notes=tuple(notes))


def _may_be_color(role: Role) -> bool:
    return role.use == "color" or (role.use == "coverage" and role.channel == "alpha")


@dataclass(frozen=True)
class _Partner:
    """The normal map that belongs to a roughness, or the reason why there is none."""

    normal_map: bpy.types.Image | None
    channel: str = "all"
    problem: str = ""


def _partners(found: Mapping[bpy.types.Image, _ImageUses]) -> dict[bpy.types.Image, _Partner]:
    """Returns the partner of each image from which shaders read roughness."""
    shaders: dict[bpy.types.Image, list[image_roles.Roughness]] = {}
    for material in dict.fromkeys(m for uses in found.values() for m in uses.shown_by):
        for roughness in image_roles.roughness(material):
            shaders.setdefault(roughness.image, []).append(roughness)
    return {rough: _partner(rough, users, found) for rough, users in shaders.items()}


def _partner(
    rough: bpy.types.Image,
    shaders: Sequence[image_roles.Roughness],
    found: Mapping[bpy.types.Image, _ImageUses],
) -> _Partner:
    normal_maps = {shader.normal_maps for shader in shaders}
    if normal_maps == {()}:
        return _Partner(None)
    problem = "does not compensate for detail lost in normal map levels"
    if len(normal_maps) > 1 or len(next(iter(normal_maps))) > 1:
        names = listed(sorted({image.name for maps in normal_maps for image in maps}))
        none = ", or with none" if () in normal_maps else ""
        return _Partner(None, problem=f"{problem}: shaders combine it with {names}{none}")
    ((normal_map,),) = normal_maps
    channels = {shader.channel for shader in shaders}
    if len(channels) > 1 or "alpha" in channels:
        channel_names = ", ".join(sorted(channels))
        problem = f"{problem}: shaders take roughness from its channels {channel_names}"
        return _Partner(None, problem=problem)
    if normal_map == rough:
        return _Partner(None, problem=f"{problem}: it is the normal map itself")
    if any(
        uses != found[normal_map].uses.get(material) for material, uses in found[rough].uses.items()
    ):
        problem = f"{problem}: '{normal_map.name}' has other UVs, or is not in all materials"
        return _Partner(None, problem=problem)
    return _Partner(normal_map, channels.pop())


def _pair(
    items: list[Item],
    rough: bpy.types.Image,
    partner: _Partner,
    found: Mapping[bpy.types.Image, _ImageUses],
) -> None:
    """Links the item of a roughness to that of its normal map."""
    index = _index(items, rough, is_normal=False)
    if index is None:
        return
    if partner.problem:
        items[index] = replace(items[index], notes=(*items[index].notes, partner.problem))
    normal_map = partner.normal_map
    if normal_map is None:
        return
    other = _index(items, normal_map, is_normal=True)
    if other is None:
        return
    if items[other].content != "normal" or items[index].content != "data":
        return
    items[index] = replace(
        items[index],
        normal_map=items[other].key,
        roughness_channel=partner.channel,
        is_alone=set(found[rough].shown_by) != set(found[normal_map].shown_by),
    )


def _index(items: Sequence[Item], image: bpy.types.Image, *, is_normal: bool) -> int | None:
    """Returns the index of an image's item that is a normal map, or is not; else its first item."""
    own = [i for i, item in enumerate(items) if item.full_name == image.name_full]
    matching = [i for i in own if (items[i].content == "normal") == is_normal]
    return next(iter(matching or own), None)
