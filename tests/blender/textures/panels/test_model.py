# SPDX-License-Identifier: GPL-3.0-or-later

"""The bake of all images in a window that nobody sees: Esc leaves nothing, undo takes it back."""

from pathlib import Path

SESSION = Path(__file__).with_name("model_session.py")
NAMES = ["First", "Second", "Third"]


def test_modal_bake_of_all_images(found):
    assert found["tab"] == "Prefilter"
    assert found["started"] == ["RUNNING_MODAL"]
    assert found["after_cancel"] == {"images": NAMES, "files": []}
    assert found["after_bake"]["files"] == [f"{name}.tif" for name in NAMES]
    levels = [f"{name}.mip{i:02d}" for name in NAMES for i in range(1, 10)]
    assert found["after_bake"]["images"] == sorted([*NAMES, *levels])
    assert found["after_undo"] == NAMES


def test_export(found):
    """Exports all images as KTX 2 into a chosen folder, and one image as DDS by its extension."""
    assert found["exported"] == [*(f"{name}.ktx2" for name in NAMES), "one.dds"]
