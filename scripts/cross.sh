# SPDX-License-Identifier: GPL-3.0-or-later

# shellcheck shell=bash
# Functions that build the package for systems other than this machine's. Source it after lib.sh.

# Blender's names of them. Each has a toolchain in native/cross/zig.cmake, and a build folder build/cross/<platform>.
platforms=(linux-x64 linux-arm64 windows-x64 macos-arm64)
# The Pythons of the official Blenders: 4.2 to 5.0, and from 5.1 on.
official_tags=(cp311 cp313)
zig_dir=$cache_dir/zig-$(sha256sum <"$source_dir/scripts/toolchain.txt" | cut -c 1-12)

# ensure_zig: installs the compiler of scripts/toolchain.txt, with a program for each of its parts as CMake wants them.
ensure_zig() {
  lock "$cache_dir/.zig.lock"
  if [[ ! -e $zig_dir ]]; then
    local part new=$zig_dir.new
    note "fetching the compiler of scripts/toolchain.txt from PyPI"
    rm -rf "$new"
    logged zig.log /usr/bin/python3 -m pip install --disable-pip-version-check --no-deps --require-hashes \
      --only-binary :all: --target "$new" --requirement "$source_dir/scripts/toolchain.txt"
    for part in cc c++ ar ranlib; do
      # shellcheck disable=SC2016
      printf '#!/bin/sh\nexec "${0%%/*}/../ziglang/zig" %s "$@"\n' "$part" >"$new/bin/zig-$part"
      chmod +x "$new/bin/zig-$part"
    done
    mv "$new" "$zig_dir"
  fi
  unlock "$cache_dir/.zig.lock"
}

# linux_headers TAG: prints a folder with the headers of a Python for Linux, and nothing else of this machine's.
linux_headers() {
  local folder=$cache_dir/python-linux/$1 source=/usr/include/python3.${1#cp3} own
  # The files of all architectures but pyconfig.h are equal, and that of arm64 differs from this one in what only the
  # interpreter's own sources ask for.
  own=$(uname -m)-linux-gnu
  if [[ ! -e $source/Python.h ]]; then
    source=$headers_dir/trixie/$1
  fi
  [[ -e $source/Python.h ]] || fail "the headers of Python 3.${1#cp3} are missing: install python3.${1#cp3}-dev"
  if [[ ! -e $folder || $source -nt $folder ]]; then
    local new=$folder.new arch pyconfig=$source/$own/python3.${1#cp3}/pyconfig.h
    [[ -e $pyconfig ]] || pyconfig=/usr/include/$own/python3.${1#cp3}/pyconfig.h
    rm -rf "$new"
    mkdir -p "$new"
    cp -RLp "$source/." "$new/"
    for arch in x86_64 aarch64; do
      mkdir -p "$new/$arch-linux-gnu/python3.${1#cp3}"
      cp -L "$pyconfig" "$new/$arch-linux-gnu/python3.${1#cp3}/"
    done
    rm -rf "$folder"
    mv "$new" "$folder"
  fi
  printf '%s\n' "$folder"
}

# ensure_cpython PLATFORM TAG: fetches CPython for Windows or macOS; prints the folder of its headers.
ensure_cpython() {
  local system=${1%%-*} version=3.${2#cp3} release classifier hash
  case $1-$2 in
    windows-x64-cp311)
      release=3.11.3-1.5.9 classifier=windows-x86_64
      hash=3263a50b256447bb7b9e604d6587627e419891370fc33b94469e6a06ff4de834
      ;;
    windows-x64-cp313)
      release=3.13.0-1.5.11 classifier=windows-x86_64
      hash=dd3590a19413e7e3e8b01d8dfd88ee2fc97f2fd0079e50d47fa6a55c41b0afc3
      ;;
    # There is none for arm64; of what its headers tell, only the size of long double differs, which no header asks for.
    macos-arm64-cp311)
      release=3.11.3-1.5.9 classifier=macosx-x86_64
      hash=223aed1538351b9df68781f60afa865c5ca6cc640353cb5d46b4706049cec5e4
      ;;
    macos-arm64-cp313)
      release=3.13.0-1.5.11 classifier=macosx-arm64
      hash=7ad951d158fcb50d5fc3d485712c700c248ce1c747a64148c7dfda5ec140cf0b
      ;;
    *) fail "there is no CPython of $2 for $1" ;;
  esac
  fetch_maven "python-$system-$version" "org.bytedeco:cpython:$release:jar:$classifier" "$hash"
  local folder=$cache_dir/python-$system-$version/org/bytedeco/cpython/$classifier/include
  [[ $system == windows ]] || folder+=/python$version
  printf '%s\n' "$folder"
}

# cross_headers PLATFORM: prints TAG=FOLDER;... as CMake wants them.
cross_headers() {
  local tag folder found=()
  for tag in "${official_tags[@]}"; do
    case $1 in
      linux-*) folder=$(linux_headers "$tag") ;;
      *) folder=$(ensure_cpython "$1" "$tag") ;;
    esac
    found+=("$tag=$folder")
  done
  (
    IFS=';'
    printf '%s\n' "${found[*]}"
  )
}

# configure_cross PLATFORM [NAME=VALUE...]: prepares build/cross/<platform>.
configure_cross() {
  local headers
  ensure_zig
  headers=$(cross_headers "$1")
  configure "cross/$1" "PREFILTER_PLATFORM=$1" "PREFILTER_ZIG=$zig_dir/bin" "PREFILTER_PYTHON_HEADERS=$headers" \
    "PREFILTER_PYBIND11_INCLUDE=$headers_dir/trixie/pybind11-include" "${source_options[@]}" \
    "PREFILTER_WHEELS=$wheels_dir" "${@:2}"
}

# build_cross PLATFORM TARGET...: builds in build/cross/<platform>, prepared before.
build_cross() {
  compile "cross/$1" "${@:2}"
}
