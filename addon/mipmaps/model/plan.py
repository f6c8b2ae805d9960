# SPDX-License-Identifier: GPL-3.0-or-later

"""Which images a model has, and what its nodes say about each: no pixel is read for it."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import bpy

from ...bridge import derived, image_roles, images, level_images, materials, meshes, users
from ...bridge.image_roles import Role
from ...core.wording import listed

Shown = Mapping[bpy.types.Object, Sequence[bpy.types.Material]]
"""Objects with the materials that they show."""

_PART = "\0"
"""What is between the full name of an image and the part of it; no name has it."""
_CHANNEL = {"red": " (red)", "green": " (green)", "blue": " (blue)", "alpha": " (alpha)"}


@dataclass(frozen=True)
class Item:
    """An image, and how it is to be baked. Datablocks are named, as an undo would end them.

    Attributes:
        image: Its name.
        full_name: The name, and the file that it is linked from.
        objects: The names of the objects whose surfaces count.
        uses: What the shaders take of it, such as "Base Color" and "Roughness (green)".
        content: A key of `choices.CONTENTS`; "cutout" if its pixels agree.
        threshold: Of the alpha test of a cut-out.
        tests_alpha: Whether that is a test of the alpha channel instead of the color.
        channels: The channels that shaders read: "all", "red", "green", "blue", "alpha".
        normal_map: The key of the normal map that it is the roughness of; empty for none.
        roughness_channel: Where the roughness is, a key of `contents.CHANNELS`.
        is_alone: Whether its surfaces are not all of those that show the normal map, so that both
            cannot be baked at once.
        notes: What a user should know.
        materials: The names of the materials that show it.
        part: Which of its roles this is, where others have an item of their own: "normal", or empty
            for all others.
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
        """What tells it from all other items."""
        return f"{self.full_name}{_PART}{self.part}" if self.part else self.full_name


@dataclass(frozen=True)
class Job:
    """What is baked at once.

    Attributes:
        item: The image.
        roughness: The roughness image that is baked with this normal map; None for none.
        normal_map: The key of the normal map that is read for this roughness image; empty for none.
    """

    item: Item
    roughness: Item | None = None
    normal_map: str = ""

    @property
    def images(self) -> list[str]:
        """The names of the images that it bakes."""
        return [one.image for one in (self.item, self.roughness) if one is not None]


@dataclass(frozen=True)
class LeftOut:
    """An image that is not baked, and why."""

    image: str
    reason: str


@dataclass(frozen=True)
class Plan:
    """The images of a model.

    Attributes:
        items: Those to bake, in the order in which objects show them.
        left_out: The others.
    """

    items: list[Item]
    left_out: list[LeftOut]

    def jobs(self) -> list[Job]:
        """Returns what to do, each image once: a normal map brings its roughness along."""
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
class _Found:
    """What is known of an image."""

    objects: dict[str, None] = field(default_factory=dict)
    shown_by: dict[bpy.types.Material, None] = field(default_factory=dict)
    roles: dict[Role, None] = field(default_factory=dict)
    places: dict[bpy.types.Material, frozenset[materials.ImageUse]] = field(default_factory=dict)
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
    """Returns what there is to bake.

    Args:
        view_layer: The objects that may be shown.
        depsgraph: Its dependency graph, evaluated before.
        chosen: Whose images, and whose surfaces count; None for all visible objects. What an image
            is, all visible objects say.
        material: The name of the material whose images are baked; empty for all.
        by_role: Whether an image that is a normal map and something else gets an item for each.

    Raises:
        ValueError: There is no such material.
    """
    if material and material not in bpy.data.materials:
        raise ValueError(f"Material: there is no '{material}' in this file")
    shown = users.shown_materials(depsgraph)
    wanted = dict.fromkeys(shown if chosen is None else chosen)
    for obj in wanted:
        shown.setdefault(obj, meshes.materials_of_objects([obj]))
    found = _look(shown, wanted)
    for obj in view_layer.objects:
        if obj not in shown and not obj.visible_get(view_layer=view_layer):
            for image in meshes.images_of_objects([obj]):
                found.setdefault(image, _Found()).hidden[obj.name] = None
    partners = _partners(found)
    items: list[Item] = []
    left_out: list[LeftOut] = []
    for image, known in found.items():
        if not known.objects or not _is_of(known, material):
            continue
        reason = _why_left_out(image, known)
        if reason:
            left_out.append(LeftOut(image.name, reason))
        else:
            items += _items(image, known, by_role=by_role)
    for rough, partner in partners.items():
        _pair(items, rough, partner, found)
    for image in bpy.data.images:
        known = found.get(image, _Found())
        if material or known.objects or _is_internal(image):
            continue
        reason = "as no mesh shows it" if chosen is None else "as none of these objects shows it"
        if known.hidden:
            reason = f"as only hidden objects show it, {listed(known.hidden)}"
        left_out.append(LeftOut(image.name, reason))
    return Plan(items, left_out)


def said_of(image: bpy.types.Image, shown_by: Iterable[bpy.types.Material]) -> Item:
    """Returns what materials say of an image, of whatever objects."""
    known = _Found()
    for material in shown_by:
        known.shown_by[material] = None
        known.roles.update(_roles(image, material))
    return _item(image, known)


def image_of(key: str) -> bpy.types.Image:
    """Returns the image of a full name, or of the key of an item.

    Raises:
        ValueError: It is gone.
    """
    full_name = key.partition(_PART)[0]
    for image in bpy.data.images:
        if image.name_full == full_name:
            return image
    raise ValueError(f"image '{full_name}': is no longer there")


def _look(shown: Shown, wanted: Mapping[bpy.types.Object, None]) -> dict[bpy.types.Image, _Found]:
    """Returns what all materials say about images, and which of the wanted objects show them."""
    found: dict[bpy.types.Image, _Found] = {}
    known: dict[bpy.types.Material, list[bpy.types.Image]] = {}
    for obj, worn in shown.items():
        for material in worn:
            if material not in known:
                known[material] = materials.images_of(material)
                for image in known[material]:
                    _add(found.setdefault(image, _Found()), image, material)
            if obj in wanted:
                for image in known[material]:
                    found[image].objects[obj.name] = None
    return found


def _add(known: _Found, image: bpy.types.Image, material: bpy.types.Material) -> None:
    uses, problems = materials.image_uses(material, image)
    known.shown_by[material] = None
    known.places[material] = frozenset(uses)
    known.problems.update(dict.fromkeys(problems))
    known.roles.update(_roles(image, material))


def _roles(image: bpy.types.Image, material: bpy.types.Material) -> dict[Role, None]:
    return {role: None for role in image_roles.roles(material) if role.image == image}


def _is_data(image: bpy.types.Image, known: _Found) -> bool:
    """Tells whether an image is no color: one that is a color and data at once is both."""
    if not image.colorspace_settings.is_data:
        return False
    is_read_as_data = any(role.use == "data" and not role.is_factor for role in known.roles)
    return not is_read_as_data or not any(
        image_roles.shows_as_color(material, image) for material in known.shown_by
    )


def _why_left_out(image: bpy.types.Image, known: _Found) -> str:
    kind = images.kind_that_is_not_read(image)
    if kind is not None:
        return f"as it is {kind}; a still image is needed"
    if not any(known.places.values()):
        return f"as it has no UVs: {'; '.join(known.problems)}"
    return ""


def _is_of(known: _Found, material: str) -> bool:
    return not material or any(one.name == material for one in known.shown_by)


def _is_internal(image: bpy.types.Image) -> bool:
    """Tells whether an image is one that Blender or the add-on has made of something else."""
    return (
        images.kind_that_is_not_read(image) in {"a render result", "a viewer image"}
        or level_images.is_level(image)
        or derived.source_of(image) is not None
    )


def _items(image: bpy.types.Image, known: _Found, *, by_role: bool) -> list[Item]:
    normal = {role: None for role in known.roles if role.use == "normal"}
    others = {role: None for role in known.roles if role.use != "normal"}
    if not (by_role and normal and others):
        return [_item(image, known)]
    first = _item(image, replace(known, roles=others))
    return [first, replace(_item(image, replace(known, roles=normal)), part="normal")]


def _item(image: bpy.types.Image, known: _Found) -> Item:
    roles = [role for role in known.roles if not role.is_factor]
    masks = [role for role in known.roles if role.is_factor]
    uses = [f"{role.label}{_CHANNEL.get(role.channel, '')}" for role in roles]
    uses += [f"mask of {role.label}{_CHANNEL.get(role.channel, '')}" for role in masks]
    notes: list[str] = []
    item = Item(
        image.name,
        image.name_full,
        tuple(known.objects),
        tuple(dict.fromkeys(uses)),
        "data" if _is_data(image, known) else "color",
        channels=frozenset(role.channel for role in known.roles),
        materials=frozenset(material.name for material in known.shown_by),
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
                f"is tested at {' and '.join(f'{one:g}' for one in sorted(tests))}; its cut-out "
                f"keeps the coverage at {threshold:g}"
            )
    if item.content == "color" and roles and not any(_may_be_color(role) for role in roles):
        notes.append(
            f"has the color space {image.colorspace_settings.name}, though shaders do not "
            f"read it as a color: {', '.join(item.uses)}; if its values are data, set "
            "Non-Color"
        )
    maps = {use.uv_map for places in known.places.values() for use in places}
    if len(maps) > 1:
        names = listed(name or "the active one" for name in sorted(maps))
        notes.append(f"is shown by several UV maps, which all count: {names}")
    if known.hidden:
        notes.append(f"is shown by hidden objects too, which do not count: {listed(known.hidden)}")
    return replace(item, notes=tuple(notes))


def _may_be_color(role: Role) -> bool:
    return role.use == "color" or (role.use == "coverage" and role.channel == "alpha")


@dataclass(frozen=True)
class _Partner:
    """The normal map that a roughness image goes with, or why there is none."""

    normal_map: bpy.types.Image | None
    channel: str = "all"
    problem: str = ""


def _partners(found: Mapping[bpy.types.Image, _Found]) -> dict[bpy.types.Image, _Partner]:
    """Returns what goes with each image that shaders take roughness from."""
    shaders: dict[bpy.types.Image, list[image_roles.Roughness]] = {}
    for material in dict.fromkeys(m for known in found.values() for m in known.shown_by):
        for one in image_roles.roughness(material):
            shaders.setdefault(one.image, []).append(one)
    return {rough: _partner(rough, known, found) for rough, known in shaders.items()}


def _partner(
    rough: bpy.types.Image,
    shaders: Sequence[image_roles.Roughness],
    found: Mapping[bpy.types.Image, _Found],
) -> _Partner:
    normal_maps = {one.normal_maps for one in shaders}
    if normal_maps == {()}:
        return _Partner(None)
    who = "does not compensate for detail lost in normal map levels"
    if len(normal_maps) > 1 or len(next(iter(normal_maps))) > 1:
        names = listed(sorted({one.name for maps in normal_maps for one in maps}))
        none = ", or with none" if () in normal_maps else ""
        return _Partner(None, problem=f"{who}: shaders combine it with {names}{none}")
    ((normal_map,),) = normal_maps
    channels = {one.channel for one in shaders}
    if len(channels) > 1 or "alpha" in channels:
        several = ", ".join(sorted(channels))
        return _Partner(None, problem=f"{who}: shaders take roughness from its channels {several}")
    if normal_map == rough:
        return _Partner(None, problem=f"{who}: it is the normal map itself")
    if any(
        places != found[normal_map].places.get(material)
        for material, places in found[rough].places.items()
    ):
        problem = f"{who}: '{normal_map.name}' has other UVs, or is not in all materials"
        return _Partner(None, problem=problem)
    return _Partner(normal_map, channels.pop())


def _pair(
    items: list[Item],
    rough: bpy.types.Image,
    partner: _Partner,
    found: Mapping[bpy.types.Image, _Found],
) -> None:
    """Notes in the items of a roughness image and its normal map that they belong together."""
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
    """Returns which item an image has as a normal map, or as something else; its only one if so."""
    known = [i for i, item in enumerate(items) if item.full_name == image.name_full]
    fitting = [i for i in known if (items[i].content == "normal") == is_normal]
    return next(iter(fitting or known), None)
