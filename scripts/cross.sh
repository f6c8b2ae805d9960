# SPDX-License-Identifier: GPL-3.0-or-later

# shellcheck shell=bash
# Functions that build the package for systems other than this machine's. Source it after lib.sh.

# The platforms of scripts/platforms.toml; each has a build folder build/cross/<platform>.
mapfile -t platforms < <(sed -n 's/^\[\(.*\)\]$/\1/p' "$source_dir/scripts/platforms.toml")
read -ra official_tags < <(sed -n 's/^pythons = //p' "$source_dir/scripts/platforms.toml" | tr -d '[]",')
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
  local system=${1%%-*} version=3.${2#cp3} artifact hash
  read -r artifact hash < <(sed -n "/^\[$1\]$/,/^\[/s/^$2 = \"\(.*\)\"$/\1/p" "$source_dir/scripts/platforms.toml") ||
    fail "there is no CPython of $2 for $1"
  fetch_maven "python-$system-$version" "$artifact" "$hash"
  local folder=$cache_dir/python-$system-$version/org/bytedeco/cpython/${artifact##*:}/include
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

# configure_cross PLATFORM [NAME=VALUE...]: prepares build/cross/<platform>. Each file of the library and its tests compiles
# by itself there: another compiler warns of names that files of a unit share, and system headers define words.
configure_cross() {
  local headers
  ensure_zig
  headers=$(cross_headers "$1")
  configure "cross/$1" "PREFILTER_PLATFORM=$1" "PREFILTER_ZIG=$zig_dir/bin" "PREFILTER_PYTHON_HEADERS=$headers" \
    "PREFILTER_PYBIND11_INCLUDE=$headers_dir/trixie/pybind11-include" "${source_options[@]}" \
    "PREFILTER_WHEELS=$wheels_dir" CMAKE_UNITY_BUILD=OFF "${@:2}"
}

# build_cross PLATFORM TARGET...: builds in build/cross/<platform>, prepared before.
build_cross() {
  compile "cross/$1" "${@:2}"
}
