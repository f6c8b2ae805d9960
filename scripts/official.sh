# SPDX-License-Identifier: GPL-3.0-or-later

# shellcheck shell=bash
# Functions that run tests in official builds of Blender, which PyPI has as modules of Python, `bpy`. Source it after lib.sh.

# The versions, and the Python of each.
declare -A official_pythons=([4.2]=cp311 [4.5]=cp311 [5.2]=cp313)
# Libraries that such a module needs even without a window; roots with a Blender include them.
official_packages=(libgl1 libice6 libsm6 libx11-6 libxfixes3 libxi6 libxkbcommon0 libxrender1 libxxf86vm1)

# ensure_official_group GROUP TAG: installs a group of scripts/official.txt for a Python; prints its folder.
ensure_official_group() {
  local folder requirements log=$log_dir/official.log
  requirements=$(awk -v group="$1" '$1 == group { print $2 " --hash=sha256:" $3 }' "$source_dir/scripts/official.txt")
  folder=$cache_dir/official/$1-$(sha256sum <<<"$requirements" | cut -c 1-12)
  lock "$cache_dir/.official.lock"
  if [[ ! -e $folder ]]; then
    note "fetching Blender as a module of Python, or what its tests import, from PyPI ($1)"
    mkdir -p "$log_dir"
    rm -rf "$folder.new"
    # pip runs in another Python, so the requirements of wheels are ignored.
    if ! /usr/bin/python3 -m pip install --disable-pip-version-check --no-cache-dir --no-compile --no-deps \
      --ignore-requires-python --require-hashes --only-binary :all: --python-version "3.${2#cp3}" \
      --target "$folder.new" --requirement <(printf '%s\n' "$requirements") >"$log" 2>&1; then
      note "scripts/official.txt cannot be installed: $(tail -n 1 "$log")"
      return 1
    fi
    mv "$folder.new" "$folder"
  fi
  unlock "$cache_dir/.official.lock"
  printf '%s\n' "$folder"
}

# find_official VERSION [GROUP]: installs an official build, such as 4.2, of 350 MB, and what its tests import, with GROUP
# too. Sets official, the words that start its Python. Fails where they cannot be had.
find_official() {
  local tag=${official_pythons[$1]} group folder path= python
  for group in "$1" "$tag" ${2:+"$2"}; do
    folder=$(ensure_official_group "$group" "$tag") || return 1
    path+=${path:+:}$folder
  done
  python=/usr/bin/python3.${tag#cp3}
  official=()
  if [[ -x $python ]]; then
    ((EUID != 0)) || ensure_packages "${official_packages[@]}"
  else
    use_suite trixie
    official=("${enter_root[@]}")
    "${official[@]}" test -x "$python" || return 1
  fi
  # Without Debian's packages: these are libraries of other versions than Blender's.
  official+=(env "PYTHONPATH=$path" "$python" -S)
}
