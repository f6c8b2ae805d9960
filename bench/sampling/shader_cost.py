# SPDX-License-Identifier: GPL-3.0-or-later

"""Counts the cost of a sample in a shader: texels read, and scalar operations.

Usage: python3 -m bench.sampling.shader_cost [--json FILE]

The count is over the SPIR-V that SPIRV-Tools leave of glslang's code for the HLSL of the standard
tables, with the wrap mode clamp. A vector operation counts once per component; moves do not count.
The loop over texels, the only branch, counts once per texel. Trilinear interpolation in the same
language, which reads its eight texels as tables do, is the reference; graphics cards have it built
in.
"""

import argparse
import re
import subprocess
import tempfile
from collections import Counter
from pathlib import Path

import prefilter
from prefilter.sampling.sampling_table import STANDARD_TEXELS

from bench.report import Report, add_json_option

TABLE_MAIN = """
Texture2D<float4> image;
float4 main(float2 uv : TEXCOORD0, float mip_value : TEXCOORD1) : SV_Target {
  return prefilter_sample(image, uv, mip_value);
}
"""
TRILINEAR = """
Texture2D<float4> image;

float4 bilinear(int level, int2 size, float2 uv) {
  float2 at = uv * float2(size) - 0.5;
  int2 low = int2(floor(at));
  float2 part = at - floor(at);
  int2 near = clamp(low, 0, size - 1);
  int2 far = clamp(low + 1, 0, size - 1);
  float4 left = lerp(image.Load(int3(near, level)),
                     image.Load(int3(near.x, far.y, level)), part.y);
  float4 right = lerp(image.Load(int3(far.x, near.y, level)),
                      image.Load(int3(far, level)), part.y);
  return lerp(left, right, part.x);
}

float4 main(float2 uv : TEXCOORD0, float mip_value : TEXCOORD1) : SV_Target {
  uint width, height, count;
  image.GetDimensions(0, width, height, count);
  int2 size = int2(width, height);
  float mip = clamp(mip_value, 0.0, float(count - 1));
  int finer = int(mip);
  int coarser = min(finer + 1, int(count) - 1);
  return lerp(bilinear(finer, max(size >> finer, 1), uv),
              bilinear(coarser, max(size >> coarser, 1), uv), mip - float(finer));
}
"""
KINDS = {
    "texels": r"OpImageFetch",
    "arithmetic": r"Op(F|I|S)(Add|Sub|Mul|Div|Negate)|OpDot|OpVectorTimesScalar|OpExtInst",
    "bits, conversions": r"Op(Shift|Bitwise|Convert)\w+",
    "comparisons, choices": r"OpSelect|Op(FOrd|FUnord|I|S)(Less|Greater|Equal|NotEqual)\w*",
}
INSTRUCTION = re.compile(r"^ *(?:%\w+ = )?(?P<operation>Op\w+)(?: %(?P<type>\w+))?")


def compiled(source: str) -> str:
    """Returns SPIR-V as text; loops are not unrolled."""
    command = (
        "glslangValidator -D -V -S frag -e main -o a.spv a.hlsl >&2"
        " && spirv-opt -O a.spv -o b.spv && spirv-dis b.spv"
    )
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "a.hlsl").write_text(source)
        run = subprocess.run(
            ["sh", "-c", command], cwd=folder, check=True, stdout=subprocess.PIPE, text=True
        )
    text = run.stdout
    return text[text.index("= OpFunction ") :]


def operations(code: str) -> Counter[str]:
    """Counts instructions by kind; those on vectors by their components."""
    found: Counter[str] = Counter()
    for line in code.splitlines():
        match = INSTRUCTION.match(line)
        if match is None:
            continue
        for kind, pattern in KINDS.items():
            if re.fullmatch(pattern, match["operation"]):
                vector = re.match(r"v([234])", match["type"] or "")
                found[kind] += int(vector[1]) if vector and kind != "texels" else 1
        found["arithmetic"] += 3 if match["operation"] == "OpDot" else 0  # of four components
        found["branches"] += match["operation"] == "OpBranchConditional"
    return found


def cost(source: str, texels: int) -> Counter[str]:
    """Counts the cost of a sample, given the number of passes through the loop, if any."""
    code = compiled(source)
    before, loop, rest = code.partition("OpLoopMerge")
    if not loop:
        return operations(code)
    end = re.search(r"%(\w+) %\w+ None", rest)
    assert end is not None
    body, _, after = rest.partition(f"%{end[1]} = OpLabel")
    once, each = operations(before) + operations(after), operations(body)
    assert once["branches"] + each["branches"] == 1
    return Counter({kind: once[kind] + texels * each[kind] for kind in KINDS})


def main() -> None:
    """Prints a table."""
    parser = argparse.ArgumentParser(description=__doc__)
    add_json_option(parser)
    arguments = parser.parse_args()
    rows = [
        (
            f"{texels} texels by a table",
            cost(prefilter.SamplingTable.standard("lanczos2", texels).hlsl() + TABLE_MAIN, texels),
        )
        for texels in STANDARD_TEXELS
    ]
    rows.append(("trilinear, in the shader", cost(TRILINEAR, 8)))
    report = Report()
    report.table(
        "Operations a sample",
        ["", *KINDS],
        [[name, *(str(counts[kind]) for kind in KINDS)] for name, counts in rows],
        "operations",
    )
    report.write(arguments.json)


if __name__ == "__main__":
    main()
