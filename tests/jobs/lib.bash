# To be sourced by the tests of the commands. ctest sets SWINGBANK_BIN and SWINGBANK_SOURCE.
set -euo pipefail

# shellcheck disable=SC2034 # for the tests that source this
swingbank=$SWINGBANK_BIN/swingbank
work=$(mktemp -d)
disks=()
lib_cleanup() {
  local one
  for one in "${disks[@]}"; do umount "$one"; done
  rm -rf "$work"
}
trap lib_cleanup EXIT

fail() {
  echo "FAILED: $*" >&2
  exit 1
}

# cases_of_others: sets $cases, the folder of public PSS/E cases, which are not part of this repository
cases_of_others() {
  local folder=${SWINGBANK_REFERENCE:-$SWINGBANK_SOURCE/../shared/reference}/../cases
  [[ -d $folder ]] || fail "no cases at $folder (they are not part of this repository): set SWINGBANK_REFERENCE to the" \
    "folder beside which cases/ lies, or run .ci/run --without-psse"
  # shellcheck disable=SC2034 # for the tests that source this
  cases=$folder
}

# Prints the internal commands, declared without a heading (swingbank_command, GROUP ""); --help does not list them.
internal_commands() { sed -n 's/^{"\([^"]*\)", "[^"]*", "", .*/\1/p' "$SWINGBANK_BIN/../commands/commands.inc"; }

# | holds -q PATTERN: grep that reads all input, since a program whose pipe is closed early fails by SIGPIPE
holds() { grep "$@" <<<"$(cat)"; }

# Gives the test its own mount namespace for a full and a read-only disk; the mounts end with the test.
own_mounts() {
  if [[ -n ${SWINGBANK_OWN_MOUNTS:-} ]]; then return; fi
  export SWINGBANK_OWN_MOUNTS=1
  local as_user=()
  if ((EUID != 0)); then as_user=(--user --map-root-user); fi
  lib_cleanup
  exec unshare "${as_user[@]}" --mount bash "$0"
}

# disk FOLDER SIZE [OPTION]: a file system of that size
disk() {
  mkdir -p "$1"
  mount -t tmpfs -o "size=$2" none "$1"
  disks+=("$1")
}

# leaves_nothing FOLDER: a failed command must leave no file
leaves_nothing() {
  local left
  left=$(find "$1" -type f)
  [[ -z $left ]] || fail "left behind: $left"
}

# fits_schema FILE...: the JSON results satisfy docs/reference/report.schema.json, which describes their common part
fits_schema() { fits_schema_of report "$@"; }

# fits_schema_of NAME FILE...: the same check against docs/reference/NAME.schema.json
fits_schema_of() {
  python3 - "$SWINGBANK_SOURCE/docs/reference/$1.schema.json" "${@:2}" <<'PYTHON' || fail "not as the schema describes it"
import json, sys
import jsonschema
schema, *files = [json.load(open(f)) for f in sys.argv[1:]]
jsonschema.Draft7Validator.check_schema(schema)
for name, result in zip(sys.argv[2:], files):
    for fault in jsonschema.Draft7Validator(schema).iter_errors(result):
        sys.exit(f"{name}: {'/'.join(map(str, fault.absolute_path))}: {fault.message}")
PYTHON
}

# An error message is one sentence: "<what> at <where> (<why>): <what to do>".
sentence='.+ at .+ \(.+\): .+'

# refuses NAME PATTERN COMMAND...: the command must fail with a message that matches PATTERN
refuses() { refuses_with 1 "$sentence" "$@"; }

# misused NAME PATTERN COMMAND...: as `refuses`, but for wrong options, where the message refers to --help
misused() { refuses_with 1 '--help' "$@"; }

refuses_with() {
  local expected=$1 form=$2
  shift 2
  local name=$1 pattern=$2 status=0
  shift 2
  "$@" >"$work/stdout" 2>"$work/stderr" </dev/null || status=$?
  ((status == expected)) || fail "$name: exit code $status, expected $expected; it said: $(tail -n 5 "$work/stderr")"
  grep -qE -e "$form" "$work/stderr" || fail "$name: the message has not the form '$form': $(cat "$work/stderr")"
  grep -qE -e "$pattern" "$work/stderr" || fail "$name: nothing matches '$pattern' in: $(cat "$work/stderr")"
  if grep -qiE 'terminate called|core dumped|segmentation' "$work/stderr"; then fail "$name: it crashed"; fi
  echo "ok: $name: $(grep -E -e "$form" "$work/stderr" | head -1)"
}
