# SPDX-License-Identifier: GPL-3.0-or-later

"""Shaders of sampling tables: they compile, and GLSL samples like the package."""

import itertools
import shutil
import subprocess

import numpy as np
import prefilter
import pytest
from sampling_table_files import random_table
from scenes import random_image

WRAP_MODES = ("clamp", "repeat", "border")
LANCZOS2 = prefilter.SamplingTable.standard("lanczos2", 8)
SAMPLE = "result = prefilter_sample(levels, query.xy, query.z, wrap);"


@pytest.fixture(scope="module")
def gpu():
    return pytest.importorskip("software_gpu").SoftwareGpu()


@pytest.fixture
def table(request, tmp_path):
    """A standard table of a (filter, texels), or a random one of keyword arguments."""
    if isinstance(request.param, tuple):
        return prefilter.SamplingTable.standard(*request.param)
    return random_table(tmp_path / "table.json", **request.param)


def random_levels(width, height):
    """Levels with the sizes of textures: sides that are no powers of two are rounded down."""
    return prefilter.mipmaps(random_image(0, height, width, 4), filter="lanczos2", bounds=None)


def random_queries(levels, count=500, seed=1):
    """Places, in and around the image, that floats hold exactly in texels too, and mip values."""
    rng = np.random.default_rng(seed)
    places = rng.integers(-3 * 2**14, 7 * 2**14, (count, 2)) / 2**16
    mip_values = rng.uniform(-1.0, len(levels) + 0.5, count).astype(np.float32)
    mip_values[: len(levels)] = np.arange(len(levels))
    return np.column_stack([places, mip_values]).astype(np.float64)


def cpu_samples(levels, table, queries, wrap="clamp"):
    return prefilter.sample(levels, table, queries[:, :2], np.exp2(queries[:, 2]), wrap=wrap)


RUN_TABLES = [
    ("lanczos2", 8),
    {"texels": 2, "grid": 1, "slices": 1},
    {"texels": 16, "grid": 5, "slices": 3, "degree": 2},
    {"texels": 5, "grid": 3, "slices": 4, "reach": 64},
    {"texels": 3, "grid": 16, "slices": 1, "degree": 2, "reach": 64},
]


@pytest.mark.parametrize("table", RUN_TABLES, indirect=True)
def test_glsl_samples_as_the_package_does(gpu, table):
    program = gpu.program(table.glsl(), SAMPLE)
    for width, height in [(64, 64), (100, 37), (1, 5), (13, 1), (1, 1)]:
        levels = random_levels(width, height)
        texture = gpu.texture(levels)
        queries = random_queries(levels)
        for u, v in [(0, 0), (1, 1), (2, 2), (1, 2), (0, 1)]:
            got = gpu.run(program, texture, queries, wrap=(u, v))
            wanted = cpu_samples(levels, table, queries, (WRAP_MODES[u], WRAP_MODES[v]))
            np.testing.assert_allclose(got, wanted, rtol=0, atol=5e-6)


def test_clamp_is_the_wrap_mode_by_default(gpu):
    levels = random_levels(20, 30)
    queries = random_queries(levels)
    program = gpu.program(LANCZOS2.glsl(), "result = prefilter_sample(levels, query.xy, query.z);")
    got = gpu.run(program, gpu.texture(levels), queries)
    np.testing.assert_allclose(got, cpu_samples(levels, LANCZOS2, queries), rtol=0, atol=5e-6)


def test_glsl_counts_levels_itself_and_asks_for_them_where_it_can(gpu):
    sizes = [side for k in range(1, 15) for side in (2**k - 1, 2**k, 2**k + 1)]
    queries = [(side, other) for side in sizes for other in (1, side)]
    count = gpu.program(LANCZOS2.glsl(), "result = vec4(prefilter_level_count(ivec2(query.xy)));")
    counts = gpu.run(count, None, queries)[:, 0]
    np.testing.assert_array_equal(counts, [side.bit_length() for side, _ in queries])

    levels = random_levels(32, 32)[:3]
    queries = random_queries(levels)
    program = gpu.program(LANCZOS2.glsl(), SAMPLE, version=430)
    got = gpu.run(program, gpu.texture(levels), queries)
    np.testing.assert_allclose(got, cpu_samples(levels, LANCZOS2, queries), rtol=0, atol=5e-6)

    program = gpu.program("#define PREFILTER_LEVELS 3\n" + LANCZOS2.glsl(), SAMPLE)
    got = gpu.run(program, gpu.texture(levels), queries)
    np.testing.assert_allclose(got, cpu_samples(levels, LANCZOS2, queries), rtol=0, atol=5e-6)


def test_places_and_scales_that_are_out_of_bounds(gpu):
    levels = random_levels(20, 30)
    texture = gpu.texture(levels)
    program = gpu.program(LANCZOS2.glsl(), SAMPLE)
    far = np.array([[1e30, 1e30, 1.3], [-1e30, 1e9, 0.0], [np.inf, -np.inf, 2.0]])
    corners = np.array([[1.0, 1.0], [0.0, 1.0], [1.0, 0.0]]) * 100.0
    corners = np.column_stack([np.where(corners == 0.0, -100.0, corners), far[:, 2]])
    wanted = cpu_samples(levels, LANCZOS2, corners)
    np.testing.assert_allclose(gpu.run(program, texture, far), wanted, rtol=0, atol=5e-6)
    assert not gpu.run(program, texture, far, wrap=(2, 2)).any()

    coarse = np.array([[0.3, 0.6, 1e30], [0.3, 0.6, np.inf]])
    last = cpu_samples(levels, LANCZOS2, np.array([[0.3, 0.6, len(levels) - 1.0]]))
    got = gpu.run(program, texture, coarse)
    np.testing.assert_allclose(got, np.tile(last, (2, 1)), rtol=0, atol=5e-6)

    nowhere = list(itertools.product([np.nan, np.inf, 0.5], [np.nan, 0.5], [np.nan, -np.inf, 1.0]))
    for wrap in itertools.product(range(3), repeat=2):
        assert np.isfinite(gpu.run(program, texture, nowhere, wrap=wrap)).all()


def test_glsl_picks_the_texels_that_the_package_picks(gpu):
    levels = random_levels(24, 40)
    texture = gpu.texture(levels)
    program = gpu.program(
        LANCZOS2.glsl(),
        """float weight;
        ivec3 texel = prefilter_pick(levels, query.xy, query.z, wrap, query.w, weight);
        result = weight * texelFetch(levels, texel.xy, texel.z);""",
    )
    queries = random_queries(levels, 2000)
    numbers = np.random.default_rng(3).random(len(queries), np.float32)
    scales = np.exp2(queries[:, 2])
    for mode, wrap in enumerate(WRAP_MODES):
        got = gpu.run(program, texture, np.column_stack([queries, numbers]), wrap=(mode, mode))
        wanted = prefilter.sample_stochastic(
            levels, LANCZOS2, queries[:, :2], scales, numbers, wrap=wrap
        )
        same = (np.abs(got - wanted) < 5e-6).all(axis=1)
        # Numbers between two texels' may go to either.
        assert np.count_nonzero(~same) <= 2


def test_the_mip_value_is_that_of_the_longer_axis(gpu):
    rng = np.random.default_rng(2)
    jacobians = rng.normal(0.0, 0.05, (300, 2, 2)) * np.exp2(rng.uniform(-6, 6, (300, 1, 1)))
    jacobians[0] = [[1 / 24, 0.0], [0.0, 1 / 40]]
    program = gpu.program(
        LANCZOS2.glsl(), "result = vec4(prefilter_mip_value(levels, query.xy, query.zw));"
    )
    # Columns: how uv changes along a pixel, and up it.
    queries = jacobians.transpose(0, 2, 1).reshape(-1, 4)
    got = gpu.run(program, gpu.texture(random_levels(24, 40)), queries)[:, 0]
    in_texels = jacobians * np.array([[24.0], [40.0]])
    wanted = np.log2(np.linalg.svd(in_texels, compute_uv=False)[:, 0])
    np.testing.assert_allclose(got, wanted, rtol=0, atol=2e-6)
    assert np.isfinite(gpu.run(program, gpu.texture(random_levels(24, 40)), [[0.0] * 4])).all()


def test_tables_under_two_names_in_one_shader(gpu):
    few = prefilter.SamplingTable.standard("lanczos2", 4)
    levels = random_levels(33, 18)
    queries = random_queries(levels)
    program = gpu.program(
        LANCZOS2.glsl(name="sharp_8") + few.glsl(name="sharp_4"),
        """result = sharp_8_sample(levels, query.xy, query.z)
                 - 2.0 * sharp_4_sample(levels, query.xy, query.z);""",
    )
    got = gpu.run(program, gpu.texture(levels), queries)
    wanted = cpu_samples(levels, LANCZOS2, queries) - 2.0 * cpu_samples(levels, few, queries)
    np.testing.assert_allclose(got, wanted, rtol=0, atol=2e-5)


@pytest.mark.parametrize(("width", "height"), [(19, 26), (37, 100), (1, 7), (64, 32)])
def test_texels_that_the_program_reads_itself(gpu, width, height):
    """Reads levels of any sizes from one image in which they are stacked."""
    levels = prefilter.sampling_levels(random_image(0, height, width, 4), "lanczos2")
    atlas = np.zeros((sum(len(level) for level in levels), width, 4), np.float32)
    top = 0
    for level in levels:
        atlas[top : top + level.shape[0], : level.shape[1]] = level
        top += level.shape[0]
    macros = f"""uniform sampler2D atlas;
    ivec2 size_of(int level) {{ return (ivec2({width}, {height}) + (1 << level) - 1) >> level; }}
    vec4 texel_of(int level, ivec2 texel) {{
      int top = 0;
      for (int i = 0; i < level; ++i) top += size_of(i).y;
      return texelFetch(atlas, ivec2(texel.x, texel.y + top), 0);
    }}
    #define PREFILTER_FETCH(level, texel) texel_of(level, texel)
    #define PREFILTER_SIZE(level) size_of(level)
    #define PREFILTER_LEVELS {len(levels)}
    """
    program = gpu.program(
        macros + LANCZOS2.glsl(), "result = prefilter_sample(query.xy, query.z, wrap);"
    )
    texture = gpu.texture([atlas])
    queries = random_queries(levels)
    for u, v in [(0, 0), (1, 1), (1, 2)]:
        got = gpu.run(program, texture, queries, wrap=(u, v))
        wanted = cpu_samples(levels, LANCZOS2, queries, (WRAP_MODES[u], WRAP_MODES[v]))
        np.testing.assert_allclose(got, wanted, rtol=0, atol=5e-6)


GLSL_MAIN = """
uniform sampler2D image;
in vec2 uv;
out vec4 color;
void main() {
  float weight;
  ivec3 texel = prefilter_pick(image, uv, 1.5, ivec2(PREFILTER_REPEAT), 0.5, weight);
  float mip_value = prefilter_mip_value(image, dFdx(uv), dFdy(uv));
  color = prefilter_sample(image, uv, mip_value) + weight * vec4(texel, 1);
}
"""
HLSL_MAIN = """
Texture2D<float4> image;
float4 main(float2 uv : TEXCOORD0) : SV_Target {
  float weight;
  int2 wrap = int2(PREFILTER_REPEAT, PREFILTER_BORDER);
  int3 texel = prefilter_pick(image, uv, 1.5, wrap, 0.5, weight);
  float mip_value = prefilter_mip_value(image, ddx(uv), ddy(uv));
  return prefilter_sample(image, uv, mip_value) + weight * float4(texel, 1);
}
"""
COMPILED_TABLES = [
    *[(filter, 6) for filter in prefilter.SAMPLING_FILTERS],
    *[{"texels": texels, "grid": 3, "slices": 1} for texels in range(2, 17)],
    {"texels": 7, "grid": 5, "slices": 3, "degree": 2},
    {"texels": 8, "grid": 8, "slices": 4, "degree": 2},
]


def compile_shader(source, path, *arguments):
    compiler = shutil.which("glslangValidator")
    if compiler is None:
        pytest.skip("there is no glslangValidator")
    path.write_text(source)
    result = subprocess.run(
        [compiler, *arguments, path.name], cwd=path.parent, capture_output=True, text=True
    )
    assert result.returncode == 0, result.stdout
    assert "WARNING" not in result.stdout, result.stdout


@pytest.mark.parametrize("table", COMPILED_TABLES, indirect=True)
def test_compilers_accept_it(table, tmp_path):
    compile_shader("#version 330 core\n" + table.glsl() + GLSL_MAIN, tmp_path / "a.frag")
    compile_shader(
        table.hlsl() + HLSL_MAIN,
        tmp_path / "a.hlsl",
        *["-D", "-V", "-S", "frag", "-e", "main", "-o", "a.spv"],
    )


@pytest.mark.parametrize("wrap", ["CLAMP", "REPEAT", "BORDER"])
def test_nothing_branches_but_the_loop_over_texels(wrap, tmp_path):
    if shutil.which("spirv-opt") is None:
        pytest.skip("there is no spirv-opt")
    main = f"""Texture2D<float4> image;
    float4 main(float3 at : TEXCOORD0) : SV_Target {{
      return prefilter_sample(image, at.xy, at.z, int2(PREFILTER_{wrap}, PREFILTER_CLAMP));
    }}"""
    arguments = ["-D", "-V", "-S", "frag", "-e", "main", "-o", "a.spv"]
    compile_shader(LANCZOS2.hlsl() + main, tmp_path / "a.hlsl", *arguments)
    for command in (["spirv-opt", "-O", "a.spv", "-o", "b.spv"], ["spirv-dis", "b.spv"]):
        result = subprocess.run(
            command, cwd=tmp_path, check=True, stdout=subprocess.PIPE, text=True
        )
    assert result.stdout.count("OpBranchConditional") == 1
    assert "OpSwitch" not in result.stdout


@pytest.mark.parametrize("version", ["300 es", "310 es", "430 core", "460 core"])
def test_other_versions_of_glsl(version, tmp_path):
    for table in (LANCZOS2, random_table(tmp_path / "table.json", degree=2)):
        source = f"#version {version}\n{table.glsl()}"
        if version.endswith("es"):
            source += "out highp vec4 color;".join(GLSL_MAIN.split("out vec4 color;"))
        else:
            source += GLSL_MAIN
        compile_shader(source, tmp_path / "a.frag")


def test_it_declares_nothing_that_a_host_declares(tmp_path):
    source = LANCZOS2.glsl()
    code = "\n".join(line.partition("//")[0] for line in source.splitlines())
    words = set(code.replace("(", " ").replace(";", " ").split())
    assert not words & {"#version", "uniform", "in", "layout", "main"}
    assert "__" not in code.replace("__VERSION__", "")
    compile_shader(
        f"#version 330 core\n{source}\nuniform sampler2D s; void main() "
        "{ gl_Position = prefilter_sample(s, vec2(0.5), 0.0); }",
        tmp_path / "a.vert",
    )


@pytest.mark.parametrize("name", ["", "_a", "a_", "a__b", "gl_a", "1a", "a-b", "a b", "ä", None, 3])
@pytest.mark.parametrize("language", ["glsl", "hlsl", "osl"])
def test_names_that_are_none(language, name):
    with pytest.raises(ValueError, match="name"):
        getattr(LANCZOS2, language)(name=name)


def test_osl_holds_the_table():
    source = LANCZOS2.osl(name="lanczos")
    assert "shader lanczos(" in source
    count = sum(LANCZOS2.section(levels).coefficients.size for levels in (1, 2, 3))
    assert f"float coefficients[{count}]" in source
    assert source.count("{") == source.count("}")
