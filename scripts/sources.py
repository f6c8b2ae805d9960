#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later

"""Fetch what scripts/sources.toml lists: the sources of libraries that are linked in.

usage: sources.py CACHE MIRROR

Each goes to CACHE/<name>-<version>, unless that is there. MIRROR is one of Debian's. Where PyPI is,
pip says; where crates.io is, cargo: its configuration, or else its source.
"""

import fnmatch
import functools
import hashlib
import json
import os
import re
import shutil
import ssl
import subprocess
import sys
import tomllib
import urllib.request
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from urllib.parse import urljoin

TABLE = Path(__file__).with_suffix(".toml")
PIP = ("/usr/bin/python3", "-m", "pip", "--disable-pip-version-check")
# Its text says where crates.io is; any release since cargo has it from there over HTTP will do.
CARGO = "r/rust-cargo/librust-cargo-dev_0.66.0-1_amd64.deb"
CARGO_SHA256 = "f5c09031a87f439049bc4cb888c19d319d7c4816611b1b58515f4fd8fdaa934a"


class SourceError(Exception):
    """A source cannot be had; the message says why."""


def read_table() -> dict[str, dict[str, Any]]:
    """Returns scripts/sources.toml: its tables by name."""
    return tomllib.loads(TABLE.read_text())


def pip_setting(name: str) -> str:
    """Returns a setting of pip's, from its environment or its files; empty where it has none."""
    done = subprocess.run((*PIP, "config", "list"), capture_output=True, text=True)
    found = dict(re.findall(r"^(\S+?)='(.*)'$", done.stdout, re.M))
    sections = (":env:", "download", "global")
    return next((found[key] for s in sections if (key := f"{s}.{name}") in found), "")


@functools.cache
def certificates() -> ssl.SSLContext:
    """Returns whom to trust: whom pip trusts, or else the system."""
    return ssl.create_default_context(cafile=pip_setting("cert") or None)


def fetch(url: str, accept: str = "*/*") -> bytes:
    """Returns the content at a URL."""
    headers = {"Accept": accept, "User-Agent": "prefilter"}
    request = urllib.request.Request(url, headers=headers)
    try:
        with urllib.request.urlopen(request, timeout=60, context=certificates()) as answer:
            return bytes(answer.read())
    except (OSError, ValueError) as error:
        raise SourceError(f"{url}: {error}") from error


def fetch_from_debian(mirror: str, path: str, sha256: str, target: Path) -> None:
    """Fetches a file of pool/main, as apt does."""
    url = f"{mirror.rstrip('/')}/pool/main/{path}"
    helper = ("/usr/lib/apt/apt-helper", "download-file", url, str(target), f"SHA256:{sha256}")
    done = subprocess.run(helper, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0:
        raise SourceError(f"{url}: {done.stdout.strip()}")


def fetch_from_pypi(project: str, archive: str) -> bytes:
    """Fetches a project's file from the index that pip uses."""
    index = pip_setting("index-url")
    if not index:
        program = "from pip._internal.models.index import PyPI; print(PyPI.simple_url)"
        index = subprocess.run(
            (PIP[0], "-c", program), check=True, capture_output=True, text=True
        ).stdout.strip()
    page = f"{index.rstrip('/')}/{project}/"
    links = re.findall(r'<a\b[^>]*\bhref="([^"#]*)', fetch(page, accept="text/html").decode())
    for link in links:
        if link.rpartition("/")[2] == archive:
            return fetch(urljoin(page, link))
    raise SourceError(f"{page} lists no {archive}")


def configured_index() -> str:
    """Returns the registry that stands for crates.io in cargo's configuration; empty where none."""
    home = Path(os.environ.get("CARGO_HOME") or Path.home() / ".cargo")
    file = next((home / name for name in ("config.toml", "config") if (home / name).exists()), None)
    sources = tomllib.loads(file.read_text()).get("source", {}) if file else {}
    name = "crates-io"
    while "replace-with" in sources.get(name, {}):
        name = sources[name]["replace-with"]
    return str(sources.get(name, {}).get("registry", ""))


def default_index(mirror: str, folder: Path) -> str:
    """Returns where cargo has crates.io from, as its source says."""
    package = folder / "cargo.deb"
    fetch_from_debian(mirror, CARGO, CARGO_SHA256, package)
    subprocess.run(("dpkg-deb", "--extract", package, folder), check=True)
    (text,) = folder.glob("usr/share/cargo/registry/cargo-*/src/cargo/sources/registry/mod.rs")
    found = re.search(r'CRATES_IO_HTTP_INDEX: &str = "(.*)"', text.read_text())
    if not found:
        raise SourceError(f"{CARGO} does not say where crates.io is")
    return found[1]


def fetch_crate(crate: str, mirror: str, folder: Path) -> bytes:
    """Fetches a crate, NAME-VERSION, from the registry that cargo uses."""
    index = configured_index() or default_index(mirror, folder)
    name, _, version = crate.rpartition("-")
    base = index.removeprefix("sparse+")
    template = json.loads(fetch(urljoin(base, "config.json")))["dl"]
    if "{" not in template:
        template += "/{crate}/{version}/download"
    return fetch(template.replace("{crate}", name).replace("{version}", version))


def fetch_archive(source: Mapping[str, Any], mirror: str, folder: Path) -> Path:
    """Fetches a source's archive to a folder; returns where it is."""
    target = folder / "source.tar"
    if "debian" in source:
        fetch_from_debian(mirror, source["debian"], source["sha256"], target)
    elif "pypi" in source:
        target.write_bytes(fetch_from_pypi(source["pypi"], source["archive"]))
    else:
        target.write_bytes(fetch_crate(source["crate"], mirror, folder))
    found = hashlib.sha256(target.read_bytes()).hexdigest()
    if found != source["sha256"]:
        raise SourceError(f"{target} has the hash {found}, not {source['sha256']}")
    return target


def license_text(source: Mapping[str, Any], unpacked: Path) -> str:
    """Returns the license of an archive that has been unpacked."""
    text = (unpacked / source["license"]).read_text()
    if "license_from" not in source:
        return text
    lines = text.splitlines(keepends=True)
    first = next(i for i, line in enumerate(lines) if line.startswith(source["license_from"]))
    last = next(i for i, line in enumerate(lines) if line.startswith(source["license_to"]))
    return "".join(lines[first:last])


def keep(source: Mapping[str, Any], unpacked: Path, target: Path) -> None:
    """Moves the parts of an unpacked archive that the table keeps to `target`."""
    text = license_text(source, unpacked)
    for folder, patterns in source["kept"].items():
        (target / folder).mkdir(parents=True, exist_ok=True)
        for pattern in patterns:
            parent, _, name = pattern.rpartition("/")
            entries = sorted((unpacked / parent).iterdir())
            found = [entry for entry in entries if fnmatch.fnmatchcase(entry.name, name)]
            if not found:
                raise SourceError(f"{TABLE.name}: the archive holds no {pattern}")
            for entry in found:
                entry.rename(target / folder / entry.name)
    (target / "LICENSE.txt").write_text(text)


def has_all(source: Mapping[str, Any], target: Path) -> bool:
    """Returns whether a folder has all that the table keeps; an earlier table may keep less."""
    return target.exists() and all(
        any(target.joinpath(folder).glob(pattern.rpartition("/")[2]))
        for folder, patterns in source["kept"].items()
        for pattern in patterns
    )


def ensure(name: str, source: Mapping[str, Any], cache: Path, mirror: str) -> None:
    """Makes a source's folder in the cache, unless it is there."""
    target = cache / name
    if has_all(source, target):
        return
    origin = source.get("debian") or source.get("archive") or source["crate"]
    print(f"prefilter: fetching {origin}", file=sys.stderr, flush=True)
    work = cache / f"{name}.source"
    shutil.rmtree(work, ignore_errors=True)
    (work / "archive").mkdir(parents=True)
    (work / "unpacked").mkdir()
    archive = fetch_archive(source, mirror, work / "archive")
    subprocess.run(
        ("cmake", "-E", "tar", "xf", archive.resolve()), cwd=work / "unpacked", check=True
    )
    keep(source, work / "unpacked", work / "kept")
    shutil.rmtree(target, ignore_errors=True)
    (work / "kept").rename(target)
    shutil.rmtree(work)


def main() -> int:
    """Runs the command line."""
    if len(sys.argv) != 3:
        print("usage: sources.py CACHE MIRROR", file=sys.stderr)
        return 2
    try:
        for name, source in read_table().items():
            ensure(name, source, Path(sys.argv[1]), sys.argv[2])
    except SourceError as error:
        print(f"prefilter: {error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
