"""An empty Blender with the add-on enabled, for every test."""

import importlib
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import addon_utils
import bpy
import pytest

PACKAGE = "bl_ext.user_default.prefilter"
TEXTURED = Path(__file__).resolve().parents[3] / "shared" / "data" / "textured"


@pytest.fixture(autouse=True)
def empty_blender() -> None:
    """Starts each test from an empty file."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    assert addon_utils.enable(PACKAGE, default_set=True) is not None


@pytest.fixture
def addon() -> Callable[[str], ModuleType]:
    """Returns a function that gives a module of the add-on by its name."""
    return lambda name: importlib.import_module(f"{PACKAGE}.{name}")


@pytest.fixture
def textured() -> Path:
    """Returns the folder of the gathered textured models."""
    if not TEXTURED.is_dir():
        pytest.skip(f"there is no {TEXTURED}")
    return TEXTURED
