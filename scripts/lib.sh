# SPDX-License-Identifier: GPL-3.0-or-later

# shellcheck shell=bash
# Functions shared by the programs in scripts/. Source it; it does nothing by itself but set paths.
#
# Environment variables, all optional:
#   PREFILTER_CACHE           folder for downloads and for files made outside of the checkout
#                             (default: ${XDG_CACHE_HOME:-$HOME/.cache}/prefilter)
#   PREFILTER_BLENDER         the Blender to use; else `blender` on PATH if it is 4.2 or later; else the
#                             one of a Debian root that is made in the cache folder
#   PREFILTER_SUITE           the Debian release of that root: trixie (13, Blender 4.3; the default) or sid
#   PREFILTER_MIRROR          Debian mirror for that root (default: that of the host's own packages)

set -euo pipefail
{ true <&0; } 2>/dev/null || exec </dev/null

source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
build_dir=$source_dir/build
cache_dir=${PREFILTER_CACHE:-${XDG_CACHE_HOME:-${HOME:-/root}/.cache}/prefilter}
headers_dir=$cache_dir/python-headers
# Source folders of linked libraries: NAME=FOLDER.
linked_sources=()
while IFS= read -r folder; do
  name=${folder%-*}
  linked_sources+=("${name^^}=$cache_dir/$folder")
done < <(sed -n 's/^\["\(.*\)"\]$/\1/p' "$source_dir/scripts/sources.toml")
unset folder name
source_options=("${linked_sources[@]/#/PREFILTER_}")
source_options=("${source_options[@]/=/_SOURCE=}")
# Each list has its own folder, as checkouts may differ.
wheels_dir=$cache_dir/wheels-$(cat "$source_dir"/scripts/bundled{,_modules}.txt | sha256sum | cut -c 1-12)
log_dir=$cache_dir/logs

caller_path=${PATH:-}
export PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin:$caller_path

host_packages=(ca-certificates cmake ninja-build g++ libgtest-dev python3-dev python3-pip pybind11-dev python3-numpy
  python3-pytest)
# Others do without it where it is missing.
((EUID != 0)) || host_packages+=(ccache)
# Debian's Blender comes without OpenImageIO's and OpenVDB's Python modules, without fonts and without a screen.
blender_packages=(python3-openimageio openimageio-tools python3-numpy python3-scipy python3-pytest
  python3-pil python3-openvdb fonts-dejavu-core xvfb xauth)
# Tests of shaders compile them, and run them on Mesa's software renderer.
shader_packages=(glslang-tools libegl1 python3-moderngl)
declare -A root_packages=(
  [trixie]="blender ${blender_packages[*]} ${shader_packages[*]} python3-dev pybind11-dev ca-certificates"
  [sid]="blender ${blender_packages[*]} python3-dev pybind11-dev ca-certificates python3-cattr python3-requests"
)

note() { printf 'prefilter: %s\n' "$*" >&2; }
fail() { note "$*"; exit 1; }

declare -A lock_fds=() lock_depths=()

# lock FILE: waits until no other process holds it, and holds it until as many calls of `unlock FILE`, or until the
# shell ends.
lock() {
  local fd depth=${lock_depths[$1]:-0}
  lock_depths[$1]=$((depth + 1))
  ((depth == 0)) || return 0
  mkdir -p "$(dirname "$1")"
  exec {fd}>"$1"
  lock_fds[$1]=$fd
  flock --timeout 2 "$fd" && return
  note "waiting for another run to finish ($1)"
  flock "$fd"
}

unlock() {
  local fd=${lock_fds[$1]} depth=${lock_depths[$1]}
  lock_depths[$1]=$((depth - 1))
  ((depth > 1)) || exec {fd}>&-
}

# build_lock PRESET: prints the lock file of a build folder, for changing it or for keeping it unchanged.
build_lock() { printf '%s\n' "$build_dir/.$1.lock"; }

# use_suite SUITE: lets a root of that Debian release be the root; sets suite, root_dir and enter_root, the words
# that run a command in it, with the host's folders at their places.
use_suite() {
  [[ -n ${root_packages[$1]:-} ]] || fail "PREFILTER_SUITE: found '$1'; allowed are ${!root_packages[*]}"
  suite=$1
  root_dir=$cache_dir/$suite
  enter_root=(unshare --mount --propagation unchanged -- "$source_dir/scripts/enter_root" "$root_dir" "$source_dir")
}

use_suite "${PREFILTER_SUITE:-trixie}"

# progress LOG: saves standard input in LOG, and shows its latest line now and then.
progress() {
  local line='' began=$SECONDS shown=$SECONDS status
  : >"$1"
  while true; do
    if IFS= read -r -t 5 line; then
      printf '%s\n' "$line" >>"$1"
    else
      status=$?
      ((status > 128)) || break
    fi
    if [[ $line == E:* ]] || ((SECONDS - shown >= 5)); then
      printf '  %4d s  %.100s\n' $((SECONDS - began)) "$line" >&2
      shown=$SECONDS
    fi
  done
}

# logged LOG COMMAND...: runs a command with its progress; on failure shows the end of its log.
logged() {
  local log=$log_dir/$1
  shift
  mkdir -p "$log_dir"
  "$@" </dev/null 2>&1 | progress "$log" && return
  tail -n 40 "$log" >&2
  fail "failed: $1 ... (the whole log: $log)"
}

# missing_packages [--root ROOT] PACKAGE...: prints the packages that are not installed.
missing_packages() {
  local where=() package
  if [[ $1 == --root ]]; then
    where=(--admindir "$2/var/lib/dpkg")
    shift 2
  fi
  local -A installed=()
  while read -r package _; do
    installed[$package]=1
  done < <(dpkg-query "${where[@]}" -W -f '${Package} ${db:Status-Status}\n' "$@" 2>/dev/null |
    grep ' installed$')
  for package in "$@"; do
    [[ -n ${installed[$package]:-} ]] || printf '%s\n' "$package"
  done
}

ensure_packages() {
  local missing
  mapfile -t missing < <(missing_packages "$@")
  ((${#missing[@]})) || return 0
  if ((EUID != 0)); then
    note "packages are missing; as root, run:"
    printf '  apt-get install --no-install-recommends %s\n' "${missing[*]}" >&2
    exit 1
  fi
  lock "$cache_dir/.apt.lock"
  note "installing ${missing[*]}"
  export DEBIAN_FRONTEND=noninteractive
  apt-get -q -o DPkg::Lock::Timeout=600 update </dev/null >/dev/null 2>&1 ||
    note "apt-get update had errors; going on with the lists there are"
  logged apt.log apt-get -q -y --no-install-recommends -o DPkg::Lock::Timeout=600 install "${missing[@]}"
  unlock "$cache_dir/.apt.lock"
}

# choose_blender: sets blender_kind (host or root), and for a host's Blender blender_file and blender_tag.
choose_blender() {
  local wanted=${PREFILTER_BLENDER:-} key
  blender_kind=root
  blender_file=${wanted:-$(PATH=$caller_path type -P blender || true)}
  [[ -n $blender_file ]] || return 0
  [[ -x $blender_file ]] || fail "PREFILTER_BLENDER: no program at $blender_file"
  blender_file=$(realpath --no-symlinks "$blender_file")

  key=$(stat --dereference --format '%n %s %Y' "$blender_file" | sha256sum | cut -c 1-16)
  local known=$cache_dir/blender-$key
  if [[ ! -e $known ]]; then
    mkdir -p "$cache_dir"
    "$blender_file" --background --factory-startup --python-exit-code 1 --python-expr '
import bpy, sys
print("PREFILTER", *bpy.app.version[:2], "cp%d%d" % sys.version_info[:2])' </dev/null 2>&1 |
      sed -n 's/^PREFILTER //p' >"$known.$$" || fail "$blender_file does not run"
    mv "$known.$$" "$known"
  fi
  local major minor
  read -r major minor blender_tag <"$known" || fail "$blender_file does not tell its version"
  if ((major > 4 || (major == 4 && minor >= 2))); then
    blender_kind=host
  elif [[ -n $wanted ]]; then
    fail "PREFILTER_BLENDER: $blender_file is Blender $major.$minor; 4.2 or later is needed"
  else
    note "$blender_file is Blender $major.$minor; 4.2 or later is needed, so a Debian root's is used"
  fi
}

debian_mirror() {
  local uri=${PREFILTER_MIRROR:-}
  [[ -n $uri ]] ||
    uri=$(apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 2>/dev/null |
      grep -E -m 1 '^https?://.*/debian/?$' || true)
  [[ -n $uri ]] || fail "apt's sources name no mirror of Debian: set PREFILTER_MIRROR to one"
  printf '%s\n' "$uri"
}

# remove_root FOLDER: deletes a Debian root, unless something is mounted in it.
remove_root() {
  [[ -e $1 ]] || return 0
  local folder
  folder=$(realpath "$1")
  if awk -v folder="$folder" '$5 == folder || index($5, folder "/") == 1 { found = 1 }
                              END { exit !found }' /proc/self/mountinfo; then
    fail "something is mounted in $folder (see /proc/self/mountinfo): unmount it, then try again"
  fi
  rm -rf --one-file-system "$folder"
}

# The list of packages of sid may have expired, if a mirror is behind.
make_root() {
  local mirror
  mirror=$(debian_mirror)
  note "making a Debian $suite root with Blender in $root_dir from $mirror (360 MB to fetch, about 2 minutes)"
  remove_root "$root_dir.new"
  logged "root-$suite.log" mmdebstrap --verbose --variant=minbase --include="${root_packages[$suite]// /,}" \
    --aptopt='Acquire::Languages "none"' --aptopt='APT::Install-Recommends "false"' \
    --aptopt='Acquire::Check-Valid-Until "false"' \
    --dpkgopt=force-unsafe-io \
    --dpkgopt='path-exclude=/usr/share/doc/*' --dpkgopt='path-exclude=/usr/share/man/*' \
    --dpkgopt='path-exclude=/usr/share/info/*' --dpkgopt='path-exclude=/usr/share/locale/*' \
    "$suite" "$root_dir.new" "$mirror"
  ln -sf ../proc/self/mounts "$root_dir.new/etc/mtab"
  rm -f "$root_dir.new/etc/resolv.conf"
  touch "$root_dir.new/etc/resolv.conf" "$root_dir.new/etc/hosts"
  mv "$root_dir.new" "$root_dir"
}

# ensure_sources: fetches the sources in scripts/sources.toml.
ensure_sources() {
  local source mirror
  for source in "${linked_sources[@]#*=}"; do
    [[ ! -e $source ]] || continue
    mirror=$(debian_mirror)
    mkdir -p "$cache_dir"
    /usr/bin/python3 "$source_dir/scripts/sources.py" "$cache_dir" "$mirror"
    return 0
  done
}

# fetch_maven FOLDER GROUP:NAME:VERSION:TYPE[:CLASSIFIER] SHA256: unpacks a jar from Maven Central into a folder of the
# cache, unless it exists. Maven knows the address of Central, or of its mirror.
fetch_maven() {
  local folder=$cache_dir/$1 new=$cache_dir/$1.new jars
  [[ ! -e $folder ]] || return 0
  lock "$cache_dir/.maven.lock"
  if [[ ! -e $folder ]]; then
    ensure_packages maven cmake
    note "fetching $2 from Maven Central"
    rm -rf "$new"
    mkdir -p "$new/jar"
    logged maven.log mvn --batch-mode --no-transfer-progress "-Dmaven.repo.local=$cache_dir/maven" dependency:copy \
      "-Dartifact=$2" "-DoutputDirectory=$new/jar"
    jars=("$new"/jar/*.jar)
    sha256sum --check --status <<<"$3  ${jars[0]}" || fail "$2: its hash is not $3"
    (cd "$new" && cmake -E tar xf "${jars[0]}")
    rm -r "$new/jar"
    mv "$new" "$folder"
  fi
  unlock "$cache_dir/.maven.lock"
}

# ensure_wheels: fetches the third-party wheels that the extension includes: wheels of pure Python, and in the folder
# modules compiled wheels for each platform and Python.
ensure_wheels() {
  [[ ! -e $wheels_dir ]] || return 0
  local platform python
  note "fetching the wheels of scripts/bundled.txt from PyPI"
  rm -rf "$wheels_dir.new"
  logged wheels.log /usr/bin/python3 -m pip download --disable-pip-version-check --no-deps --only-binary :all: \
    --require-hashes --dest "$wheels_dir.new" --requirement "$source_dir/scripts/bundled.txt"
  for platform in manylinux2014_{x86_64,aarch64}/{311,313,314} {win_amd64,macosx_11_0_arm64}/{311,313}; do
    python=${platform#*/}
    logged wheels.log /usr/bin/python3 -m pip download --disable-pip-version-check --no-deps --only-binary :all: \
      --require-hashes --platform "${platform%/*}" --implementation cp --python-version "$python" --abi "cp$python" \
      --dest "$wheels_dir.new/modules" --requirement "$source_dir/scripts/bundled_modules.txt"
  done
  mv "$wheels_dir.new" "$wheels_dir"
}

# ensure_reader: fetches the reader of compiled modules; sets reader_dir.
ensure_reader() {
  reader_dir=$cache_dir/packager-$(/usr/bin/python3 -V | cat - "$source_dir/scripts/packager.txt" | sha256sum | cut -c 1-12)
  [[ ! -e $reader_dir ]] || return 0
  note "fetching what scripts/packager.txt lists from PyPI"
  rm -rf "$reader_dir.new"
  logged packager.log /usr/bin/python3 -m pip install --disable-pip-version-check --no-deps --only-binary :all: \
    --require-hashes --target "$reader_dir.new" --requirement "$source_dir/scripts/packager.txt"
  mv "$reader_dir.new" "$reader_dir"
}

# ensure_site_tools: installs the packages in scripts/site.txt from PyPI; sets site_tools.
ensure_site_tools() {
  local folder
  folder=$cache_dir/site-$(sha256sum <"$source_dir/scripts/site.txt" | cut -c 1-12)
  lock "$cache_dir/.site.lock"
  if [[ ! -e $folder/.made ]]; then
    /usr/bin/python3 -c 'import ensurepip' 2>/dev/null || ensure_packages python3-venv
    note "fetching the tools of scripts/site.txt from PyPI"
    logged site-tools.log /usr/bin/python3 -m venv --clear "$folder"
    logged site-tools.log "$folder/bin/pip" install --disable-pip-version-check --requirement "$source_dir/scripts/site.txt"
    touch "$folder/.made"
  fi
  unlock "$cache_dir/.site.lock"
  site_tools=$folder/bin
}

# ensure_decoders TAG: installs the packages in scripts/decoders.txt for a Python such as cp313. Sets decoders, empty if
# they are not available, and tests skip.
ensure_decoders() {
  local folder log=$log_dir/decoders-$1.log
  folder=$cache_dir/decoders-$1-$(sha256sum <scripts/decoders.txt | cut -c 1-12)
  decoders=$folder
  lock "$cache_dir/.decoders.lock"
  if [[ ! -e $folder ]]; then
    mkdir -p "$log_dir"
    rm -rf "$folder.new"
    if /usr/bin/python3 -m pip install --disable-pip-version-check --no-deps --require-hashes --only-binary :all: \
      --python-version "3.${1#cp3}" --target "$folder.new" --requirement scripts/decoders.txt >"$log" 2>&1; then
      mv "$folder.new" "$folder"
    else
      note "scripts/decoders.txt cannot be installed for Python 3.${1#cp3}: $(tail -n 1 "$log")"
      decoders=
    fi
  fi
  unlock "$cache_dir/.decoders.lock"
}

ensure_root() {
  local stamp=$root_dir/.prefilter-packages missing packages
  read -ra packages <<<"${root_packages[$suite]}"
  ! cmp --silent "$stamp" <(printf '%s\n' "${packages[@]}") || return 0
  ((EUID == 0)) ||
    fail "no Blender 4.2 or later on PATH: install one, set PREFILTER_BLENDER, or run this as root"
  ensure_packages mmdebstrap mount
  if [[ -e $root_dir ]]; then
    mapfile -t missing < <(missing_packages --root "$root_dir" "${packages[@]}")
    if ((${#missing[@]})); then
      note "installing ${missing[*]} in $root_dir"
      logged root-install.log "${enter_root[@]}" sh -c '
        export DEBIAN_FRONTEND=noninteractive
        apt-get -q update && apt-get -q -y install "$@" && apt-get -q clean' _ "${missing[@]}"
    fi
  else
    make_root
  fi
  printf '%s\n' "${packages[@]}" >"$stamp"
}

# root_version PACKAGE: prints the version of a package in the root.
root_version() {
  dpkg-query --admindir "$root_dir/var/lib/dpkg" -W -f '${Version}' "$1"
}

# The host's compiler builds for the root's Python too: it needs the headers, and no library. Sets blender_tag.
ensure_root_headers() {
  local python version arch folder=$headers_dir/$suite new=$headers_dir/$suite.new
  python=$(compgen -G "$root_dir/usr/include/python3.*/Python.h" | head -n 1) ||
    fail "$root_dir has no Python headers: remove it and run scripts/setup"
  python=$(dirname "$python")
  version=${python##*/python3.}
  blender_tag=cp3$version
  ! cmp --silent "$folder/.stamp" "$root_dir/.prefilter-packages" || return 0
  arch=$(uname -m)-linux-gnu
  rm -rf "$new"
  mkdir -p "$new/$blender_tag/$arch" "$new/pybind11-include"
  cp -RLp "$python/." "$new/$blender_tag/"
  cp -RLp "$root_dir/usr/include/$arch/python3.$version" "$new/$blender_tag/$arch/"
  cp -RLp "$root_dir/usr/include/pybind11" "$new/pybind11-include/"
  # A new Python requires a new pybind11, which is found first.
  ln -s ../pybind11-include/pybind11 "$new/$blender_tag/pybind11"
  cp "$root_dir/.prefilter-packages" "$new/.stamp"
  rm -rf "$folder"
  mv "$new" "$folder"
}

# find_headers: sets python_headers to TAG=FOLDER;... and pybind11_include, in the form for CMake.
find_headers() {
  local folder tag
  local -A found=()
  for folder in /usr/include/python3.* "$headers_dir"/*/cp3*; do
    [[ -e $folder/Python.h && $folder != *.new/* ]] || continue
    tag=${folder##*/}
    tag=${tag/#python3./cp3}
    if ((${tag#cp3} >= 11)) && [[ -z ${found[$tag]:-} ]]; then
      found[$tag]=$folder
    fi
  done
  python_tags=()
  python_headers=
  while read -r tag; do
    python_tags+=("$tag")
    python_headers+="${python_headers:+;}$tag=${found[$tag]}"
  done < <(printf '%s\n' "${!found[@]}" | sort)
  [[ -n ${found[$blender_tag]:-} ]] ||
    fail "Blender's Python is 3.${blender_tag#cp3}, and its headers are missing: install python3.${blender_tag#cp3}-dev"
  pybind11_include=/usr/include
  folder=$headers_dir/trixie/pybind11-include
  [[ ! -e $folder ]] || pybind11_include=$folder
}

# use_ccache: reuses earlier compilations of any checkout from a cache, unless the caller has chosen a launcher.
use_ccache() {
  [[ -z ${CMAKE_CXX_COMPILER_LAUNCHER:-} ]] && type -P ccache >/dev/null || return 0
  export CMAKE_C_COMPILER_LAUNCHER=ccache CMAKE_CXX_COMPILER_LAUNCHER=ccache
  export CCACHE_DIR=${CCACHE_DIR:-$cache_dir/ccache} CCACHE_MAXSIZE=${CCACHE_MAXSIZE:-2G}
  # Required for precompiled headers; paths are relative to the checkout.
  export CCACHE_SLOPPINESS=pch_defines,time_macros,include_file_mtime,include_file_ctime
  export CCACHE_BASEDIR=$source_dir CCACHE_NOHASHDIR=1
}

# setup_host: installs or fetches the requirements of a build, and sets blender_kind and, for a host's Blender, blender_file.
setup_host() {
  lock "$cache_dir/.lock"
  choose_blender
  ensure_packages "${host_packages[@]}"
  use_ccache
  ensure_sources
  ensure_wheels
  ensure_reader
  unlock "$cache_dir/.lock"
}

# setup: installs or makes everything that is missing, and sets blender_kind, blender_tag, host_tag, python_tags (all
# Pythons with headers), own_tags (the Pythons of Blender and of python3 beside it), python_headers and
# pybind11_include.
setup() {
  lock "$cache_dir/.lock"
  setup_host
  if [[ $blender_kind == root ]]; then
    ensure_root
    ensure_root_headers
  elif [[ $(realpath "$blender_file") == /usr/bin/* ]]; then
    ensure_packages "${blender_packages[@]}"
  fi
  find_headers
  host_tag=$(/usr/bin/python3 -c 'import sys; print("cp%d%d" % sys.version_info[:2])')
  own_tags=("$blender_tag")
  [[ $blender_kind == root || $host_tag == "$blender_tag" || " ${python_tags[*]} " != *" $host_tag "* ]] ||
    own_tags+=("$host_tag")
  unlock "$cache_dir/.lock"
}

# configured FOLDER NAME=VALUE...: whether that build folder was configured with these.
configured() {
  local folder=$1 option values
  shift
  [[ -e $folder/build.ninja && -e $folder/CMakeCache.txt ]] || return 1
  values=$(sed -E 's/^([A-Za-z0-9_]+):[A-Z]+=/\1=/' "$folder/CMakeCache.txt")
  for option in "$@"; do
    [[ $'\n'$values$'\n' == *$'\n'"$option"$'\n'* ]] || return 1
  done
}

# configure PRESET NAME=VALUE...: runs cmake unless the build folder is configured with these values. Beside the presets of
# CMakePresets.json there is cross/<platform>, for each table of scripts/platforms.toml.
configure() {
  local preset=$1 folder=$build_dir/$1 how=(--preset "$1")
  # Zig has a cache of its own.
  [[ $preset != cross/* ]] ||
    how=(-S . -B "$folder" -G Ninja --toolchain "$source_dir/native/cross/zig.cmake" -DCMAKE_BUILD_TYPE=Release
      -DCMAKE_C_COMPILER_LAUNCHER= -DCMAKE_CXX_COMPILER_LAUNCHER=)
  shift
  lock "$(build_lock "$preset")"
  if ! configured "$folder" "CMAKE_HOME_DIRECTORY=$source_dir" "$@"; then
    note "configuring build/$preset"
    mkdir -p "$folder"
    rm -f "$folder/build.ninja"
    if ! (cd "$source_dir" && cmake --fresh "${how[@]}" "${@/#/-D}") </dev/null >"$folder/.configured" 2>&1; then
      cat "$folder/.configured" >&2
      fail "cmake failed"
    fi
  fi
  unlock "$(build_lock "$preset")"
}

# compile PRESET TARGET...: runs ninja; prints, on standard error, only when there is work.
compile() {
  local preset=$1
  shift
  lock "$(build_lock "$preset")"
  NINJA_STATUS='[%f/%t %e s] ' ninja -C "$build_dir/$preset" "$@" </dev/null 2>&1 |
    sed --unbuffered -e '/^ninja: \(no work to do\|Entering directory\)/d' -e '/^-- /d' \
      -e '/Re-checking globbed directories/d' >&2
  unlock "$(build_lock "$preset")"
}

# native_files: sets files to all C++ sources that the formatter covers.
native_files() {
  mapfile -d '' files < <(find native examples bench tests/native \( -name '*.h' -o -name '*.cpp' \) -print0)
}

# ensure_tools: installs the tools in scripts/tools.txt from PyPI, as Debian 12 lacks them or has old ones. Sets tools.
ensure_tools() {
  local folder=$cache_dir/tools log=$log_dir/tools.log
  lock "$cache_dir/.tools.lock"
  if ! cmp --silent scripts/tools.txt "$folder/.stamp"; then
    mkdir -p "$log_dir"
    /usr/bin/python3 -c 'import ensurepip' 2>/dev/null || ensure_packages python3-venv
    if ! {
      /usr/bin/python3 -m venv --clear "$folder" &&
        "$folder/bin/pip" install --disable-pip-version-check --requirement scripts/tools.txt
    } >"$log" 2>&1; then
      skip "scripts/tools.txt cannot be installed: $(tail -n 1 "$log")"
    fi
    cp scripts/tools.txt "$folder/.stamp"
  fi
  unlock "$cache_dir/.tools.lock"
  tools=$folder/bin
}

configure_release() {
  configure release "PREFILTER_PYTHON_HEADERS=$python_headers" "PREFILTER_PYBIND11_INCLUDE=$pybind11_include" \
    "${source_options[@]}" "PREFILTER_WHEELS=$wheels_dir"
}

# build_packages TAG...: brings the packages of these Pythons up to date.
build_packages() {
  lock "$(build_lock release)"
  configure_release
  compile release "${@/#/package_}"
  unlock "$(build_lock release)"
}

# exec_with_blender COMMAND...: becomes a command that has that Blender on PATH and the package importable.
exec_with_blender() {
  if [[ $blender_kind == root ]]; then
    export PYTHONPATH=$build_dir/release/python/$blender_tag
    exec "${enter_root[@]}" "$@"
  fi
  local shim=$build_dir/blender-shim
  mkdir -p "$shim"
  [[ $(readlink "$shim/blender") == "$blender_file" ]] || ln -sfn "$blender_file" "$shim/blender"
  exec env PATH="$shim:/usr/local/bin:/usr/bin:/bin:$caller_path" \
    PYTHONPATH="$build_dir/release/python/$host_tag${PYTHONPATH:+:$PYTHONPATH}" "$@"
}

# package_with COMMAND ARGUMENT...: runs scripts/packager with the command that starts Blender.
package_with() {
  local blender=("$blender_file")
  [[ $blender_kind != root ]] || blender=("${enter_root[@]}" blender)
  /usr/bin/python3 "$source_dir/scripts/packager" "$@" "--reader=$reader_dir" -- "${blender[@]}"
}

# package_extension TAGS [--install FOLDER]: makes build/prefilter-<version>.zip for these Pythons (TAG or 'TAG TAG...')
# where its contents are new, and sets extension_zip to it. Their packages must be built. FOLDER, for
# BLENDER_USER_RESOURCES, then has it installed and enabled.
package_extension() {
  local tags
  read -ra tags <<<"$1"
  lock "$(build_lock release)"
  extension_zip=$(package_with extension "${tags[@]/#/--tag=}" "${linked_sources[@]/#*=/--linked=}" \
    "--wheels=$wheels_dir" "${@:2}")
  unlock "$(build_lock release)"
}

# ensure_extension: packages the extension for this Blender and installs it in build/blender/<tag>, where its contents
# are new; then Blender is to use that folder, unless the caller has set BLENDER_USER_RESOURCES.
ensure_extension() {
  [[ -z ${BLENDER_USER_RESOURCES:-} ]] || return 0
  package_extension "$blender_tag" --install "$build_dir/blender/$blender_tag"
  export BLENDER_USER_RESOURCES=$build_dir/blender/$blender_tag
}
