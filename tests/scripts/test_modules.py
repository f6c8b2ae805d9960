# SPDX-License-Identifier: GPL-3.0-or-later

"""The properties read from compiled modules, and each of their faults in a module that has it."""

import struct
from pathlib import Path

import pytest
from small_modules import SUFFIXES, compiled

lief = pytest.importorskip("lief")

from packager.check_wheel import module_faults, system_faults  # noqa: E402
from packager.modules import Module, read_module  # noqa: E402
from packager.platforms import PLATFORMS, glibc_here, platform_of_wheel  # noqa: E402

each_platform = pytest.mark.parametrize("platform", SUFFIXES)


def faults(path: Path, platform: str) -> str:
    return "; ".join(module_faults(read_module(path), "cp311", PLATFORMS[platform]))


@each_platform
def test_a_module_of_each_platform_is_fine(platform: str, tmp_path: Path) -> None:
    path = compiled(platform, tmp_path)
    module = read_module(path)
    assert faults(path, platform) == ""
    assert module.exports == {"PyInit__native"}
    expected = {"windows-x64": (6, 0), "macos-arm64": (11, 0), "linux-arm64": (0, 0)}
    if platform in expected:
        assert module.lowest == expected[platform]


@each_platform
def test_other_exports_are_found(platform: str, tmp_path: Path) -> None:
    path = compiled(platform, tmp_path, before="VISIBLE int leaked(void) { return 2; }")
    assert faults(path, platform) == "exports ['PyInit__native', 'leaked'], not just PyInit__native"


@each_platform
def test_a_module_of_another_platform_is_found(platform: str, tmp_path: Path) -> None:
    path = compiled(platform, tmp_path)
    for other in PLATFORMS.keys() - {platform}:
        assert f"not for {other}" in faults(path, other)


@pytest.mark.parametrize("platform", ["linux-x64", "linux-arm64", "macos-arm64"])
def test_a_library_that_not_every_system_has_is_found(platform: str, tmp_path: Path) -> None:
    other = compiled(
        platform, tmp_path, before="VISIBLE int other(void) { return 2; }", name="libother.so"
    )
    path = compiled(platform, tmp_path, str(other), before="int other(void);", result="other()")
    assert "libother.so" in faults(path, platform).partition("needs [")[2]


def test_a_library_that_not_every_windows_has_is_found(tmp_path: Path) -> None:
    path = compiled(
        "windows-x64",
        tmp_path,
        "-lwinmm",
        before="__declspec(dllimport) unsigned __stdcall timeGetTime(void);",
        result="(int)timeGetTime()",
    )
    assert "needs ['WINMM.dll']" in faults(path, "windows-x64")


@pytest.mark.parametrize(
    ("platform", "library", "allowed"),
    [
        ("linux-x64", "libc.so.6", True),
        ("linux-x64", "libstdc++.so.6", False),
        ("linux-x64", "ld-linux-x86-64.so.2", True),
        ("linux-arm64", "libgomp.so.1", False),
        ("windows-x64", "python311.dll", True),
        ("windows-x64", "python313.dll", False),
        ("windows-x64", "KERNEL32.dll", True),
        ("windows-x64", "api-ms-win-crt-math-l1-1-0.dll", True),
        ("windows-x64", "libstdc++-6.dll", False),
        ("windows-x64", "VCRUNTIME140.dll", False),
        ("macos-arm64", "/usr/lib/libSystem.B.dylib", True),
        ("macos-arm64", "/usr/lib/libc++.1.dylib", False),
        ("macos-arm64", "@rpath/libomp.dylib", False),
    ],
)
def test_libraries_of_the_system_are_allowed(platform: str, library: str, allowed: bool) -> None:
    module = Module(PLATFORMS[platform].form, PLATFORMS[platform].machine, {"PyInit__native"})
    module.libraries = {library}
    found = module_faults(module, "cp311", PLATFORMS[platform])
    assert found == ([] if allowed else [f"needs ['{library}']"])


@pytest.mark.parametrize(
    ("flags", "before", "fault"),
    [
        (["-Wl,-z,execstack"], "", "executable stack"),
        (["-Wl,-rpath,/opt", "-Wl,--enable-new-dtags"], "", "RUNPATH"),
        (["-Wl,-rpath,/opt", "-Wl,--disable-new-dtags"], "", "RPATH"),
        (
            ["-Wl,-z,notext"],
            'int data; __asm__(".pushsection .text\\n.quad data\\n.popsection");',
            "relocations in its code",
        ),
    ],
)
def test_faults_of_elf_are_found(flags: list[str], before: str, fault: str, tmp_path: Path) -> None:
    path = compiled("linux-x64", tmp_path, *flags, before=before)
    assert fault in faults(path, "linux-x64")


@each_platform
def test_what_debuggers_need_is_found(platform: str, tmp_path: Path) -> None:
    flag = "-gdwarf" if platform == "windows-x64" else "-g"
    path = compiled(platform, tmp_path, flag, strip=False)
    assert "is not stripped" in faults(path, platform)


def with_word(path: Path, offset: int, value: int) -> Path:
    """Writes a 16-bit number at an offset from a PE file's optional header."""
    data = bytearray(path.read_bytes())
    header = struct.unpack_from("<I", data, 0x3C)[0] + 24
    struct.pack_into("<H", data, header + offset, value)
    path.write_bytes(data)
    return path


def test_faults_of_pe_are_found(tmp_path: Path) -> None:
    path = compiled("windows-x64", tmp_path)
    subsystem, characteristics = 48, 70
    assert read_module(with_word(path, subsystem, 10)).lowest == (10, 0)
    assert "DYNAMIC_BASE" in faults(with_word(path, characteristics, 0x100), "windows-x64")
    assert "executable stack" in faults(with_word(path, characteristics, 0x40), "windows-x64")


def test_a_newer_macos_is_found(tmp_path: Path) -> None:
    path = compiled("macos-arm64", tmp_path)
    data = bytearray(path.read_bytes())
    build_version = data.index(struct.pack("<3I", 0x32, 32, 1))  # Command, size, macOS.
    struct.pack_into("<I", data, build_version + 12, 13 << 16 | 1 << 8)
    path.write_bytes(data)
    assert read_module(path).lowest == (13, 1)
    assert system_faults((13, 1), (13, 1), (11, 0)) == [
        "needs version 13.1 of the system, newer than 11.0"
    ]


def test_a_search_path_of_macho_is_found(tmp_path: Path) -> None:
    path = compiled("macos-arm64", tmp_path, "-Wl,-rpath,/opt")
    assert "RPATH" in faults(path, "macos-arm64")


def test_a_signature_that_macos_would_refuse_is_found(tmp_path: Path) -> None:
    path = compiled("macos-arm64", tmp_path)
    data = bytearray(path.read_bytes())
    code = data.index(b"PyInit__native")
    for at in (code, len(data) // 2):
        changed = bytearray(data)
        changed[at] ^= 1
        path.write_bytes(changed)
        assert "changed after it was signed" in faults(path, "macos-arm64")
    path.write_bytes(data)
    both = lief.MachO.parse(str(path))
    module = both.at(0)
    module.remove_signature()
    module.write(str(path))
    assert "is not signed" in faults(path, "macos-arm64")


def test_a_newer_glibc_is_found(tmp_path: Path) -> None:
    if glibc_here() < (2, 34):
        pytest.skip("this machine's glibc is older than 2.34")
    # Since 2.34 it is a part of libc.so.6, under a version of its own.
    path = compiled(
        "linux-x64", tmp_path, before="int pthread_join();", result="pthread_join(0, 0)"
    )
    assert read_module(path).lowest == (2, 34)


def test_the_system_that_a_wheel_is_for_is_the_one_in_its_name() -> None:
    named = {
        "x-1-cp311-cp311-manylinux_2_28_x86_64.whl": ("linux-x64", (2, 28)),
        "x-1-cp311-cp311-manylinux_2_17_aarch64.whl": ("linux-arm64", (2, 17)),
        "x-1-cp311-cp311-win_amd64.whl": ("windows-x64", (6, 3)),
        "x-1-cp311-cp311-macosx_11_0_arm64.whl": ("macos-arm64", (11, 0)),
    }
    for name, (platform, lowest) in named.items():
        assert platform_of_wheel(name) == (PLATFORMS[platform], lowest)
    for last in ("linux_x86_64", "win32", "macosx_11_0_x86_64", "musllinux_1_2_x86_64", "any"):
        assert platform_of_wheel(f"x-1-cp311-cp311-{last}.whl") is None
    assert system_faults((2, 17), (2, 28), (2, 28)) == []
    assert len(system_faults((2, 29), (2, 28), (2, 28))) == 2
    assert len(system_faults((2, 17), (2, 29), (2, 28))) == 1


def test_what_is_no_module_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "_native.so"
    path.write_text("text")
    with pytest.raises(ValueError, match="neither ELF, nor PE, nor Mach-O"):
        read_module(path)
