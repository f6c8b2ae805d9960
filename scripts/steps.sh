# SPDX-License-Identifier: GPL-3.0-or-later

# shellcheck shell=bash
# Steps that are functions, run side by side, as many as there are processors. Source it.
#
# Environment variables, optional:
#   PREFILTER_TEST_ONLY       if set, only the steps whose names match this regular expression are declared

readonly skipped=77
results=$(mktemp -d) # The files of running steps, and the data that a step leaves for later ones.
trap 'rm -rf "$results"' EXIT
functions=()
declare -A names=() needs=()
summary=()
count_passed=0 count_failed=0 count_skipped=0

# step NAME FUNCTION [NEED...]: declares a step. It is run once those whose functions are NEED have ended, if they run.
step() {
  [[ $1 =~ ${PREFILTER_TEST_ONLY:-} ]] || return 0
  functions+=("$2")
  names[$2]=$1
  needs[$2]=${*:3}
}

skip() {
  printf 'skipped: %s\n' "$*"
  exit "$skipped"
}

# run_step FUNCTION: runs a step in a subshell; leaves its status and its times in files.
run_step() {
  local status began=$SECONDS
  printf '\n=== %s\n' "${names[$1]}"
  # Bash ignores errexit in commands before || and in an if.
  set +e
  (
    set -e
    "$1"
  )
  status=$?
  set -e
  times >"$results/$1.times"
  printf '%d %d\n' "$status" $((SECONDS - began)) >"$results/$1.status"
}

# conclude FUNCTION: counts a step that has run.
conclude() {
  local status=1 seconds=0 processors=0 result
  # A step that was killed has left nothing.
  if [[ -e $results/$1.status ]]; then
    read -r status seconds <"$results/$1.status"
    processors=$(awk -F '[ms ]+' 'END { printf "%d", 60 * ($1 + $3) + $2 + $4 + 0.5 }' "$results/$1.times")
  fi
  case $status in
    0)
      result=passed
      count_passed=$((count_passed + 1))
      ;;
    "$skipped")
      result=skipped
      count_skipped=$((count_skipped + 1))
      ;;
    *)
      result=FAILED
      count_failed=$((count_failed + 1))
      ;;
  esac
  printf -- '--- %s: %s (%d s)\n' "${names[$1]}" "$result" "$seconds"
  summary+=("$(printf '%-8s %4d s %5d s  %s' "$result" "$seconds" "$processors" "${names[$1]}")")
}

# is_ready FUNCTION: whether all steps that it needs have ended.
is_ready() {
  local need
  for need in ${needs[$1]}; do
    [[ -z ${names[$need]:-} || -e $results/$need.ended ]] || return 1
  done
}

# run_side_by_side: runs those declared, the first that is ready first, and prints each when it has ended.
run_side_by_side() {
  local pending=("${functions[@]}") waiting function ends running=0
  mkfifo "$results/ends"
  exec {ends}<>"$results/ends"
  while ((${#pending[@]} + running > 0)); do
    waiting=()
    for function in "${pending[@]}"; do
      if ((running < $(nproc))) && is_ready "$function"; then
        printf '... %s\n' "${names[$function]}"
        {
          (run_step "$function") >"$results/$function.log" 2>&1 &
          wait "$!" || true
          printf '%s\n' "$function" >&"$ends"
        } &
        running=$((running + 1))
      else
        waiting+=("$function")
      fi
    done
    pending=("${waiting[@]}")
    read -r function <&"$ends"
    running=$((running - 1))
    touch "$results/$function.ended"
    cat "$results/$function.log"
    conclude "$function"
  done
}

# run_steps: runs those declared, and prints a summary: seconds that passed, and those of processors. Fails where one did.
run_steps() {
  local total
  if ((${#functions[@]} == 1)); then
    (run_step "${functions[0]}")
    conclude "${functions[0]}"
  else
    run_side_by_side
  fi
  printf '\n=== summary, %d s\n' "$SECONDS"
  printf '%s\n' "${summary[@]}"
  total="$count_passed passed, $count_failed failed"
  ((count_skipped == 0)) || total+=", $count_skipped skipped"
  printf '%s\n' "$total"
  ((count_failed == 0))
}
