# SPDX-License-Identifier: GPL-3.0-or-later

"""Reads the headers of compiled modules in three formats: ELF, PE (Windows), Mach-O (macOS).

Needs LIEF, the library that reads them; scripts/packager.txt has its version.
"""

import hashlib
import re
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import lief

from packager.platforms import Version

lief.logging.disable()

# glibc 2.41 does not load such a module.
_STACK = "wants an executable stack"
_STAB = 0xE0  # The bits of a Mach-O symbol that only those of debuggers have.
# Zig's linker defines these where ld64 keeps them to itself; no one links to them.
_OF_MACHO_LINKERS = {"___dso_handle", "__mh_dylib_header"}


@dataclass
class Module:
    """The properties of a module that its loader checks.

    Attributes:
        form: ELF, PE or Mach-O.
        machine: x86_64 or arm64; any other as LIEF names it.
        exports: The names that others can link to.
        libraries: The libraries loaded with it.
        lowest: The lowest version of the system that it runs on: glibc, Windows or macOS.
        faults: Any other reason that would keep it from loading, or content that is out of place.
    """

    form: str
    machine: str
    exports: set[str] = field(default_factory=set)
    libraries: set[str] = field(default_factory=set)
    lowest: Version = (0, 0)
    faults: list[str] = field(default_factory=list)


def read_module(path: Path) -> Module:
    """Reads a module.

    Raises:
        ValueError: It is none of the three formats.
    """
    data = path.read_bytes()
    if lief.is_elf(str(path)):
        return _read_elf(path)
    if lief.is_pe(str(path)):
        return _read_pe(path)
    if lief.is_macho(str(path)):
        return _read_macho(path, data)
    raise ValueError(f"{path.name}: neither ELF, nor PE, nor Mach-O")


def _read_elf(path: Path) -> Module:
    elf = lief.ELF.parse(str(path))
    if elf is None:
        raise ValueError(f"{path.name}: damaged ELF")
    machines = {lief.ELF.ARCH.X86_64: "x86_64", lief.ELF.ARCH.AARCH64: "arm64"}
    machine = elf.header.machine_type
    found = Module("ELF", machines.get(machine, str(machine)))
    local = lief.ELF.Symbol.BINDING.LOCAL
    found.exports = {
        str(symbol.name)
        for symbol in elf.dynamic_symbols
        if symbol.shndx != 0 and symbol.binding != local and symbol.name
    }
    found.libraries = {str(library) for library in elf.libraries}
    versions = [
        re.fullmatch(r"GLIBC_(\d+)\.(\d+)(?:\.\d+)?", str(auxiliary.name))
        for requirement in elf.symbols_version_requirement
        for auxiliary in requirement.get_auxiliary_symbols()
    ]
    found.lowest = max(
        ((int(match[1]), int(match[2])) for match in versions if match), default=(0, 0)
    )
    if any(
        segment.type == lief.ELF.Segment.TYPE.GNU_STACK and segment.has(lief.ELF.Segment.FLAGS.X)
        for segment in elf.segments
    ):
        found.faults.append(_STACK)
    for tag, text in (
        (lief.ELF.DynamicEntry.TAG.TEXTREL, "has relocations in its code"),
        (lief.ELF.DynamicEntry.TAG.RPATH, "has a search path (RPATH)"),
        (lief.ELF.DynamicEntry.TAG.RUNPATH, "has a search path (RUNPATH)"),
    ):
        if elf.has(tag):
            found.faults.append(text)
    if any(
        section.name == ".symtab" or str(section.name).startswith(".debug_")
        for section in elf.sections
    ):
        found.faults.append("is not stripped")
    return found


def _read_pe(path: Path) -> Module:
    pe = lief.PE.parse(str(path))
    if pe is None:
        raise ValueError(f"{path.name}: damaged PE")
    machines = {
        lief.PE.Header.MACHINE_TYPES.AMD64: "x86_64",
        lief.PE.Header.MACHINE_TYPES.ARM64: "arm64",
    }
    machine = pe.header.machine
    found = Module("PE", machines.get(machine, str(machine)))
    exported = pe.get_export() if pe.has_exports else None
    found.exports = {str(entry.name) for entry in exported.entries} if exported else set()
    found.libraries = {str(library.name) for library in (*pe.imports, *pe.delay_imports)}
    header = pe.optional_header
    found.lowest = (header.major_subsystem_version, header.minor_subsystem_version)
    characteristics = lief.PE.OptionalHeader.DLL_CHARACTERISTICS
    if not header.has(characteristics.DYNAMIC_BASE):
        found.faults.append("cannot be loaded at any address (DYNAMIC_BASE)")
    if not header.has(characteristics.NX_COMPAT):
        found.faults.append(_STACK)
    # A name longer than eight letters is a number after a slash, and only those of DWARF are.
    if any(str(section.name).startswith("/") for section in pe.sections):
        found.faults.append("is not stripped")
    return found


def _read_macho(path: Path, data: bytes) -> Module:
    both = lief.MachO.parse(str(path))
    if both is None:
        raise ValueError(f"{path.name}: damaged Mach-O")
    if both.size != 1:
        raise ValueError(f"{path.name}: holds {both.size} modules, not one")
    macho = both.at(0)
    machines = {
        lief.MachO.Header.CPU_TYPE.X86_64: "x86_64",
        lief.MachO.Header.CPU_TYPE.ARM64: "arm64",
    }
    cpu = macho.header.cpu_type
    found = Module("Mach-O", machines.get(cpu, str(cpu)))
    names = {str(symbol.name) for symbol in _macho_exports(macho)} - _OF_MACHO_LINKERS
    found.exports = {name.removeprefix("_") for name in names}
    itself = lief.MachO.LoadCommand.TYPE.ID_DYLIB
    found.libraries = {
        str(library.name) for library in macho.libraries if library.command != itself
    }
    version = macho.build_version
    if version is None or version.platform != lief.MachO.BuildVersion.PLATFORMS.MACOS:
        found.faults.append("does not say for which macOS it is")
    else:
        found.lowest = (version.minos[0], version.minos[1])
    if macho.has_rpath:
        found.faults.append("has a search path (RPATH)")
    if any(symbol.raw_type & _STAB for symbol in macho.symbols):
        found.faults.append("is not stripped")
    if fault := _signature_fault(macho, data):
        found.faults.append(fault)
    return found


def _macho_exports(macho: "lief.MachO.Binary") -> "Iterator[lief.MachO.Symbol]":
    """Yields the symbols of the trie that dyld looks names up in."""
    if macho.has_dyld_info:
        yield from (each.symbol for each in macho.dyld_info.exports)
    elif macho.has_dyld_exports_trie:
        yield from (each.symbol for each in macho.dyld_exports_trie.exports)


# Constants of Apple's cs_blobs.h; numbers are big-endian.
_SUPER_BLOB, _CODE_DIRECTORY = 0xFADE0CC0, 0xFADE0C02
_SHA256 = 2


def _signature_fault(macho: "lief.MachO.Binary", data: bytes) -> str:
    """Returns the fault in the signature that macOS on arm64 requires; empty if there is none.

    Any signature will do, even an ad-hoc one, but its hashes must match the file's pages, or the
    system ends the process that loads the module.
    """
    if not macho.has_code_signature:
        return "is not signed"
    command = macho.code_signature
    start = command.data_offset
    blob = data[start : start + command.data_size]
    try:
        magic, _, count = struct.unpack_from(">III", blob)
        if magic != _SUPER_BLOB:
            return "has a damaged signature"
        checked = False
        for index in range(count):
            _, at = struct.unpack_from(">II", blob, 12 + 8 * index)
            if struct.unpack_from(">I", blob, at)[0] == _CODE_DIRECTORY:
                if not _pages_match(blob[at:], data, start):
                    return "was changed after it was signed"
                checked = True
        return "" if checked else "has a damaged signature"
    except (struct.error, IndexError):
        return "has a damaged signature"


def _pages_match(directory: bytes, data: bytes, end: int) -> bool:
    """Whether the hashes of a CodeDirectory match the file's pages before its signature."""
    hashes, _, _, pages, limit = struct.unpack_from(">IIIII", directory, 16)
    size, kind, _, page_bits = struct.unpack_from(">BBBB", directory, 36)
    if kind != _SHA256 or limit != end:
        return False
    page = 1 << page_bits
    if pages != -(-limit // page):
        return False
    for index in range(pages):
        at = hashes + index * size
        content = data[index * page : min((index + 1) * page, limit)]
        if hashlib.sha256(content).digest()[:size] != directory[at : at + size]:
            return False
    return True
