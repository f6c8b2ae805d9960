# SPDX-License-Identifier: GPL-3.0-or-later

"""Sources of linked libraries: their table, their downloads, and their kept files."""

import hashlib
import http.server
import json
import re
import subprocess
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
import sources
from small_modules import cache_folder

CHECKOUT = Path(__file__).resolve().parents[2]
HOSTS = r"pypi\.org|pythonhosted|crates\.io\b.*/|://[\w.]*crates\.io|maven\.org|maven\.apache|npmjs|debian\.org"


@pytest.fixture
def registry(tmp_path: Path) -> Iterator[tuple[str, Path]]:
    """A server of files on this machine: its address, and the folder it serves."""
    folder = tmp_path / "registry"
    folder.mkdir()

    class Quiet(http.server.SimpleHTTPRequestHandler):
        def __init__(self, *arguments: object) -> None:
            super().__init__(*arguments, directory=str(folder))  # type: ignore[arg-type]

        def log_message(self, *_: object) -> None:
            pass

    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), Quiet) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}", folder
        server.shutdown()


@pytest.mark.parametrize(("name", "source"), sources.read_table().items())
def test_a_table_says_all_that_is_needed(name: str, source: dict[str, object]) -> None:
    library, _, version = name.rpartition("-")
    assert re.fullmatch(r"[0-9.]+(beta[0-9]|\+git[0-9]{8})?", version)
    assert (CHECKOUT / "native" / library / "CMakeLists.txt").is_file()
    assert len({"debian", "pypi", "crate"} & set(source)) == 1
    assert re.fullmatch("[0-9a-f]{64}", str(source["sha256"]))
    assert source["license"]
    assert source["kept"]
    assert source["security"]


@pytest.mark.parametrize(
    ("library", "file", "pattern"),
    [
        ("basisu", "encoder/basisu_comp.h", r'BASISU_LIB_VERSION_STRING "(.*)"'),
        ("bc7enc", "bc7enc.cpp", r"Geldreich, Jr\. (\d+)/(\d+)/(\d+) "),
        ("bc7f", "basisu_transcoder_internal.h", r'BASISD_VERSION_STRING "(.*)"'),
        ("bcdec", "bcdec.h", r"bcdec\.h - v(.*)"),
        ("clipper2", "include/clipper2/clipper.version.h", r'CLIPPER2_VERSION = "(.*)"'),
        ("libdeflate", "libdeflate.h", r'LIBDEFLATE_VERSION_STRING\s+"(.*)"'),
        ("opensubdiv", "opensubdiv/version.h", r"OPENSUBDIV_VERSION v(\d)_(\d)_(\d)"),
        ("simde", "simde/simde-common.h", r"(?s)MAJOR (\d).*MINOR (\d).*MICRO (\d)"),
        ("zstd", "zstd.h", r"(?s)MAJOR +(\d).*MINOR +(\d).*RELEASE +(\d)"),
    ],
)
def test_a_version_is_the_one_that_the_source_says(library: str, file: str, pattern: str) -> None:
    (name,) = (name for name in sources.read_table() if name.startswith(f"{library}-"))
    path = cache_folder() / name / file
    if not path.exists():
        pytest.skip("scripts/setup has not been run")
    found = re.search(pattern, path.read_text())
    assert found
    said = found.groups() if library != "bc7enc" else (found[3], found[1], found[2])
    assert name == f"{library}-{'.'.join(said)}"


def test_the_scripts_know_the_same_libraries() -> None:
    program = f". '{CHECKOUT}/scripts/lib.sh'; printf '%s\\n' \"${{linked_sources[@]}}\""
    printed = subprocess.run(
        ("bash", "-c", program), check=True, capture_output=True, text=True
    ).stdout.split()
    folders = [Path(line.partition("=")[2]).name for line in printed]
    assert folders == list(sources.read_table())
    assert [line.partition("=")[0] for line in printed] == [
        name.rpartition("-")[0].upper() for name in folders
    ]


def test_no_registry_is_named() -> None:
    programs = [path for path in (CHECKOUT / "scripts").rglob("*") if path.is_file()]
    programs += [CHECKOUT / "CMakeLists.txt", *CHECKOUT.glob("native/*/CMakeLists.txt")]
    named = [
        f"{path.name}: {line}"
        for path in programs
        if "__pycache__" not in path.parts
        for line in path.read_text().splitlines()
        if re.search(HOSTS, line)
    ]
    assert len(programs) > 20
    assert named == []


def test_a_file_of_pypi_comes_from_the_index_of_pip(
    registry: tuple[str, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    address, folder = registry
    (folder / "simple/thing").mkdir(parents=True)
    (folder / "files").mkdir()
    (folder / "files/thing-1.tar.gz").write_bytes(b"the source")
    (folder / "simple/thing/index.html").write_text(
        '<a href="../../files/thing-0.tar.gz#sha256=0">a</a>\n'
        '<a data-x="y" href="../../files/thing-1.tar.gz#sha256=0">b</a>'
    )
    monkeypatch.setenv("PIP_INDEX_URL", f"{address}/simple")
    assert sources.fetch_from_pypi("thing", "thing-1.tar.gz") == b"the source"
    with pytest.raises(sources.SourceError, match=r"lists no thing-2\.tar\.gz"):
        sources.fetch_from_pypi("thing", "thing-2.tar.gz")
    with pytest.raises(sources.SourceError, match="404"):
        sources.fetch_from_pypi("other", "other-1.tar.gz")


def test_settings_of_pip_are_read_as_pip_does(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("PIP_INDEX_URL", "PIP_EXTRA_INDEX_URL"):
        monkeypatch.delenv(name, raising=False)
    (tmp_path / "pip.conf").write_text(
        "[global]\nextra-index-url = http://extra/\nindex-url = http://one/\n"
    )
    monkeypatch.setenv("PIP_CONFIG_FILE", str(tmp_path / "pip.conf"))
    assert sources.pip_setting("index-url") == "http://one/"
    monkeypatch.setenv("PIP_INDEX_URL", "http://two/")
    assert sources.pip_setting("index-url") == "http://two/"
    assert sources.pip_setting("client-cert") == ""


@pytest.mark.parametrize("template", ["", "/{crate}/{version}/download"])
def test_a_crate_comes_from_the_registry_of_cargo(
    registry: tuple[str, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch, template: str
) -> None:
    address, folder = registry
    (folder / "some-thing/1.2.3").mkdir(parents=True)
    (folder / "some-thing/1.2.3/download").write_bytes(b"the crate")
    (folder / "config.json").write_text(json.dumps({"dl": address + template}))
    (tmp_path / "config.toml").write_text(
        '[source.crates-io]\nreplace-with = "mirror"\n'
        f'[source.mirror]\nregistry = "sparse+{address}/"\n'
    )
    monkeypatch.setenv("CARGO_HOME", str(tmp_path))
    assert sources.fetch_crate("some-thing-1.2.3", "no mirror", tmp_path) == b"the crate"


def test_another_hash_is_an_error(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sources, "fetch_from_pypi", lambda *_: b"data")
    source = {"pypi": "a", "archive": "a-1.tar.gz", "sha256": hashlib.sha256(b"data").hexdigest()}
    assert sources.fetch_archive(source, "", tmp_path).read_bytes() == b"data"
    with pytest.raises(sources.SourceError, match="has the hash"):
        sources.fetch_archive({**source, "sha256": "0" * 64}, "", tmp_path)


def test_what_is_kept_lies_where_the_table_says(tmp_path: Path) -> None:
    archive = tmp_path / "archive"
    for name in ("a-1/src/deep/one.c", "a-1/src/two.c", "a-1/src/two.h", "a-1/LEGAL"):
        (archive / name).parent.mkdir(parents=True, exist_ok=True)
        (archive / name).write_text(f"{name}\nbegin here\nits terms\nend here\n")
    source = {
        "license": "a-1/LEGAL",
        "license_from": "begin",
        "license_to": "end",
        "kept": {".": ["a-1/src/deep", "a-1/src/*.c"], "inc/a": ["a-1/src/two.h"]},
    }
    with pytest.raises(sources.SourceError, match=r"no a-1/src/\*\.x"):
        sources.keep({**source, "kept": {".": ["a-1/src/*.x"]}}, archive, tmp_path / "other")
    sources.keep(source, archive, tmp_path / "kept")
    kept = [path for path in (tmp_path / "kept").rglob("*") if path.is_file()]
    assert {path.relative_to(tmp_path / "kept").as_posix() for path in kept} == {
        "deep/one.c",
        "two.c",
        "inc/a/two.h",
        "LICENSE.txt",
    }
    assert (tmp_path / "kept/LICENSE.txt").read_text() == "begin here\nits terms\n"
