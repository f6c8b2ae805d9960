# SPDX-License-Identifier: GPL-3.0-or-later

"""scripts/platforms.toml: its readers in CMake and in bash agree with Python."""

import subprocess
import tomllib
from pathlib import Path

import pytest

CHECKOUT = Path(__file__).resolve().parents[2]
TABLE = tomllib.loads((CHECKOUT / "scripts/platforms.toml").read_text())
PLATFORMS = {name: row for name, row in TABLE.items() if isinstance(row, dict)}


def in_bash(command: str) -> str:
    program = f". '{CHECKOUT}/scripts/lib.sh'; . '{CHECKOUT}/scripts/cross.sh'; {command}"
    done = subprocess.run(("bash", "-c", program), check=True, capture_output=True, text=True)
    return done.stdout


def test_bash_knows_the_platforms_and_the_pythons() -> None:
    assert in_bash('echo "${platforms[@]}"').split() == list(PLATFORMS)
    assert in_bash('echo "${official_tags[@]}"').split() == TABLE["pythons"]


@pytest.mark.parametrize("platform", ["windows-x64", "macos-arm64"])
@pytest.mark.parametrize("tag", TABLE["pythons"])
def test_bash_fetches_the_python_of_a_platform(platform: str, tag: str) -> None:
    printed = in_bash(f'fetch_maven() {{ echo "$2 $3"; }}; ensure_cpython {platform} {tag}')
    artifact, folder = printed.splitlines()
    assert artifact == PLATFORMS[platform][tag]
    assert f"/{artifact.split()[0].rpartition(':')[2]}/include" in folder


@pytest.mark.parametrize("platform", PLATFORMS)
def test_cmake_reads_what_python_reads(platform: str, tmp_path: Path) -> None:
    row = PLATFORMS[platform]
    keys = ("system", "processor", "target", "suffix", *(key for key in row if key == "emulator"))
    program = tmp_path / "read.cmake"
    program.write_text(
        f'include("{CHECKOUT}/native/cross/platform.cmake")\nread_platform({platform})\n'
        + 'message("${platform_names}")\n'
        + "".join(f'message("${{platform_{key}}}")\n' for key in keys)
    )
    done = subprocess.run(("cmake", "-P", program), check=True, capture_output=True, text=True)
    names, *values = done.stderr.splitlines()
    assert names.split(";") == list(PLATFORMS)
    assert dict(zip(keys, values, strict=True)) == {key: row[key] for key in keys}
