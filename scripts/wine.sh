# SPDX-License-Identifier: GPL-3.0-or-later

# shellcheck shell=bash
# Functions that run programs for Windows under Wine, and CPython among them. Source it after lib.sh and cross.sh.

wine_dir=$cache_dir/wine
wine_program=(env "WINEPREFIX=$wine_dir" WINEDEBUG=-all "WINEDLLOVERRIDES=mscoree,mshtml=" /usr/lib/wine/wine64)

# start_wine [ARGUMENT...]: starts the server that all programs under Wine share, and which ends a while after them. It
# inherits none of this shell's files: it would hold locks, and pipes would not end.
start_wine() (
  local fd
  for fd in "${lock_fds[@]}"; do
    exec {fd}>&-
  done
  "${wine_program[@]}" wineboot "$@" </dev/null
)

# ensure_wine: installs Wine, and makes its folder of a Windows.
ensure_wine() {
  lock "$cache_dir/.wine.lock"
  ensure_packages wine64
  if [[ ! -e $wine_dir/.made ]]; then
    note "making $wine_dir"
    mkdir -p "$log_dir"
    rm -rf "$wine_dir"
    start_wine --init >"$log_dir/wine.log" 2>&1 || fail "wineboot failed: $log_dir/wine.log"
    touch "$wine_dir/.made"
  fi
  unlock "$cache_dir/.wine.lock"
}

# under_wine PROGRAM ARGUMENT...: runs a program for Windows, and fails where that does. Its output goes through a pipe:
# Python cannot write to other files there.
under_wine() {
  start_wine >/dev/null 2>&1
  (
    set -o pipefail
    "${wine_program[@]}" "$@" </dev/null 2>&1 | stdbuf -o L tr -d '\r'
  )
}

# make_python3_dll FOLDER TAG: makes the library that modules for all Pythons 3 are linked with, beside that of one Python,
# which it passes all calls on to.
make_python3_dll() {
  local library=python${2#cp}
  ensure_zig
  {
    # shellcheck disable=SC2016
    printf '%s\n' '.globl _DllMainCRTStartup' '_DllMainCRTStartup: mov $1, %eax' ret '.section .drectve, "yn"'
    objdump -p "$1/$library.dll" | sed -n "s/^\t\[ *[0-9]*\].* \([A-Za-z_0-9]*\)\$/.ascii \" -export:\1=$library.\1\"/p"
  } >"$1/python3.s"
  "$zig_dir/bin/zig-cc" --target=x86_64-windows-gnu -shared -nostdlib -o "$1/python3.dll" "$1/python3.s"
}

# ensure_wine_python TAG: fetches CPython for Windows and the packages of scripts/wine.txt; sets wine_python, the folder
# of both.
ensure_wine_python() {
  local requirements new
  ensure_cpython windows-x64 "$1" >/dev/null
  requirements=$(awk -v tag="$1" '$1 == tag || $1 == "all" { print $2 " --hash=sha256:" $3 }' "$source_dir/scripts/wine.txt")
  wine_python=$cache_dir/wine-$1-$(sha256sum <<<"$requirements" | cut -c 1-12)
  new=$wine_python.new
  lock "$cache_dir/.wine.lock"
  if [[ ! -e $wine_python ]]; then
    note "fetching the packages of scripts/wine.txt for Python 3.${1#cp3} from PyPI"
    rm -rf "$new"
    logged wine-python.log /usr/bin/python3 -m pip install --disable-pip-version-check --no-cache-dir --no-compile \
      --no-deps --require-hashes --only-binary :all: --platform win_amd64 --python-version "3.${1#cp3}" \
      --target "$new/site-packages" --requirement <(printf '%s\n' "$requirements")
    cp -a "$cache_dir/python-windows-3.${1#cp3}"/org/bytedeco/cpython/windows-x86_64 "$new/python"
    # Wine does not support its queries of the system.
    rm -f "$new/python/lib/_wmi.pyd"
    make_python3_dll "$new/python" "$1"
    mv "$new" "$wine_python"
  fi
  unlock "$cache_dir/.wine.lock"
}

# windows_path PATH...: prints paths in the form for Windows, separated by ;.
windows_path() {
  local path paths=()
  for path in "$@"; do
    paths+=("Z:${path//\//\\}")
  done
  (
    IFS=';'
    printf '%s\n' "${paths[*]}"
  )
}

# python_under_wine TAG PACKAGES ARGUMENT...: runs that Python under Wine, with the folder PACKAGES importable.
python_under_wine() {
  local path
  ensure_wine
  ensure_wine_python "$1"
  path=$(windows_path "$2" "$wine_python/site-packages")
  PYTHONPATH=$path PYTHONDONTWRITEBYTECODE=1 PYTHONUNBUFFERED=1 under_wine "$wine_python/python/python.exe" "${@:3}"
}
