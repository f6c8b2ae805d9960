# SPDX-License-Identifier: GPL-3.0-or-later

"""Makes the modules beside the tests importable from anywhere, and selects tests."""

import collections
import os
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

# Set before numpy is there: threads that share small matrices wait for each other most of the time.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).parent))

# Numbers, and the sources: the tests of these are the same whichever Python runs them.
SAME_IN_ANY_PYTHON = {
    "test_adaptive_scans.py",
    "test_anisotropic_sampling.py",
    "test_as_solid.py",
    "test_block_effort.py",
    "test_boolean.py",
    "test_cancel.py",
    "test_clean_up.py",
    "test_close_holes.py",
    "test_color.py",
    "test_contour.py",
    "test_corner_points.py",
    "test_cutout.py",
    "test_data.py",
    "test_directions.py",
    "test_etc1s.py",
    "test_exact_sampling.py",
    "test_face_normals.py",
    "test_fit_to_views.py",
    "test_floors.py",
    "test_footprint.py",
    "test_lost_parts.py",
    "test_matrices.py",
    "test_memory_limit.py",
    "test_mipmaps_laws.py",
    "test_mipmaps_oracle.py",
    "test_mobile_textures.py",
    "test_natural_tables.py",
    "test_nearest.py",
    "test_normals.py",
    "test_normals_of_points.py",
    "test_open_surfaces.py",
    "test_opengl_bench.py",
    "test_painting.py",
    "test_pcd_files.py",
    "test_places.py",
    "test_point_choice.py",
    "test_point_clouds.py",
    "test_quads.py",
    "test_rasterize_crowded.py",
    "test_rasterize_gradients.py",
    "test_rasterize_laws.py",
    "test_rasterize_nasty.py",
    "test_rasterize_oracle.py",
    "test_read_ktx2.py",
    "test_reader.py",
    "test_reconstruct.py",
    "test_reconstruct_nasty.py",
    "test_reconstruct_sources.py",
    "test_reconstruct_steps.py",
    "test_resample.py",
    "test_resize.py",
    "test_resize_bytes.py",
    "test_rust_readers.py",
    "test_same_bits.py",
    "test_sampling_jumps.py",
    "test_sampling_laws.py",
    "test_sampling_levels.py",
    "test_sampling_oracle.py",
    "test_sampling_sample.py",
    "test_sampling_tables.py",
    "test_scan_files.py",
    "test_scan_formats.py",
    "test_scan_vertices.py",
    "test_seams.py",
    "test_sets_of_files.py",
    "test_shaders.py",
    "test_sharp.py",
    "test_sharp_edges.py",
    "test_sharp_occupancies.py",
    "test_stochastic_sampling.py",
    "test_structure.py",
    "test_subdivision.py",
    "test_surfaces.py",
    "test_svg_filter_steps.py",
    "test_svg_filters.py",
    "test_svg_geometry.py",
    "test_svg_paint.py",
    "test_svg_references.py",
    "test_svg_strokes.py",
    "test_svg_text.py",
    "test_tasks.py",
    "test_texture_use.py",
    "test_thickness.py",
    "test_thin_places.py",
    "test_thin_scans.py",
    "test_up_to_date.py",
    "test_reporters.py",
    "test_voxel_laws.py",
    "test_voxelize_oracle.py",
    "test_wavelet_shapes.py",
}

# The slowest tests whose code paths shorter tests cover too: most parameters of a function, or its
# larger case. Keyed by the module's name after test_.
LONG = {
    "adaptive_scans: a_closed_surface_stays_closed",
    "adaptive_scans: the_surface_does_not_depend_on_threads_or_memory",
    "boolean: a_primitive_with_holes_against_one_that_crosses_itself",
    "cancel: a_cancel_can_come_at_any_time[fit_to_views]",
    "cancel: a_cancel_ends_the_work[fit_to_views-0.5]",
    "clean_up: the_number_of_threads_makes_no_difference",
    "clean_up: thin_sheets_do_not_cross[linear]",
    "etc1s: quality_is_paid_for_in_bytes",
    "etc1s: threads_change_nothing[2]",
    "etc1s: threads_change_nothing[3]",
    "etc1s: threads_change_nothing[8]",
    "fit_to_views: levels_for_both_are_nearer_either_way",
    "fit_to_views: pixels_are_nearer_to_what_they_should_show[anisotropic]",
    "footprint: trilinear_levels_fit_what_pixels_cover_at_every_mip_value[1.0-size0-wrap0]",
    "lost_parts: lost_is_what_is_far_from_the_surface[0]",
    "lost_parts: lost_is_what_is_far_from_the_surface[1]",
    "memory_limit: limits_hold[ball-1.3]",
    "memory_limit: limits_hold[ball-2.0]",
    "memory_limit: limits_hold[terrain with values-2.0]",
    "memory_limit: the_least_is_enough_and_what_is_taken[ball-options0]",
    "memory_limit: the_least_is_enough_and_what_is_taken[ball-options1]",
    "memory_limit: the_least_is_enough_and_what_is_taken[ball-options2]",
    "memory_limit: the_least_is_enough_and_what_is_taken[ball-options3]",
    "memory_limit: the_least_is_enough_and_what_is_taken[sparse ball-options0]",
    "memory_limit: the_least_is_enough_and_what_is_taken[terrain with values-options0]",
    "memory_limit: the_least_is_enough_and_what_is_taken[terrain with values-options1]",
    "memory_limit: the_least_is_enough_and_what_is_taken[terrain with values-options2]",
    "memory_limit: the_least_is_enough_and_what_is_taken[terrain with values-options3]",
    "open_surfaces: thin_parts_stay[9]",
    "point_clouds: a_surface_averages_the_noise_of_all",
    "point_clouds: a_surface_brings_five_scans_back_to_a_tenth_of_a_cell[offset0]",
    "point_clouds: a_surface_brings_five_scans_back_to_a_tenth_of_a_cell[offset1]",
    "reader: levels_are_as_good_as_those_of_a_dense_solver[1]",
    "sharp_edges: contours_of_many_meshes_are_sound[clean]",
    "sharp_edges: edges_are_where_they_are[cylinder-how1]",
    "sharp_edges: random_booleans_are_sound[clean]",
}

# Tests with many similar parameters: run the first, and then one in this many.
FEW = {
    "boolean: boxes_with_faces_in_common": 2,
    "cancel: a_cancel_can_come_at_any_time": 3,
    "contour: adaptive_surfaces_stay_within_their_distance": 2,
    "footprint: levels_fit_the_image_averaged_over_the_footprint": 2,
    "mipmaps_oracle: trilinear_levels_solve_the_normal_equations_together": 2,
    "mipmaps_oracle: unbounded_levels_solve_the_normal_equations": 2,
    "natural_tables: errors_are_double_integrals_over_the_plane": 4,
    "natural_tables: no_bias_of_trilinear_interpolation_is_as_close_on_edges_and_gradients": 3,
    "reconstruct_steps: other_settings": 2,
    "sampling_laws: errors_of_samples_of_noise_are_those_of_the_table": 3,
    "sampling_laws: weights_of_the_image_are_as_far_off_as_the_table_says": 4,
    "sampling_oracle: tables_of_the_standard_shape_are_within_the_errors_that_they_state": 3,
    "sets_of_files: a_kill_at_any_call_leaves_the_old_set_or_the_new_one": 2,
}


def pytest_configure(config):
    config.addinivalue_line("markers", "once: the same whichever Python runs it, so one does")
    missing = [name for name in SAME_IN_ANY_PYTHON if not Path(__file__).with_name(name).exists()]
    assert not missing, missing


def pytest_collection_modifyitems(config, items):
    for item in items:
        if item.path.name in SAME_IN_ANY_PYTHON:
            item.add_marker(pytest.mark.once)
    if not os.environ.get("PREFILTER_TEST_ALL"):
        left_out = set(_long_ones(items))
        if not any("::" in argument for argument in config.args):
            _check_lists(items)
        config.hook.pytest_deselected(items=list(left_out))
        items[:] = [item for item in items if item not in left_out]


def _names(item):
    """Returns how LONG and FEW name a test, and its function."""
    module = item.path.stem.removeprefix("test_")
    name = f"{module}: {item.name.removeprefix('test_')}"
    return name, name.partition("[")[0]


def _long_ones(items):
    """Yields the tests that run only with PREFILTER_TEST_ALL."""
    before = collections.Counter()
    for item in items:
        name, function = _names(item)
        if name in LONG or before[function] % FEW.get(function, 1):
            yield item
        before[function] += 1


def _check_lists(items):
    """Asserts that the lists name no test that its module does not have."""
    there = {name for item in items for name in _names(item)}
    modules = {name.partition(":")[0] for name in there}
    named = {name for name in LONG | FEW.keys() if name.partition(":")[0] in modules}
    assert named <= there, sorted(named - there)


@pytest.fixture
def quick_path() -> Iterator[Path]:
    """A folder for many small files that are waited for: in memory, where the system has that."""
    place = "/dev/shm"
    is_there = os.access(place, os.W_OK)
    with tempfile.TemporaryDirectory(dir=place if is_there else None) as folder:
        yield Path(folder)
