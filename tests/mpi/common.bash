# Sourced by the scripts of this folder.
# shellcheck disable=SC2034 # used by them
set -euo pipefail
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
: "${SWINGBANK_BIN:?folder of the binaries}" "${SWINGBANK_SOURCE:?folder of the sources}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
configs=$SWINGBANK_SOURCE/configs/datasets
generate=$SWINGBANK_BIN/swingbank-generate
verify=$SWINGBANK_BIN/swingbank-verify
python3=/usr/bin/python3 # Debian's Python, which has python3-h5py
ranks() { local n=$1; shift; mpirun --oversubscribe -np "$n" "$@"; }
fail() { echo "FAILED: $*" >&2; exit 1; }
# Prints the dataset's hash after reading and checking every shard.
hash_of() { "$verify" "$1" | sed -n 's/.*dataset \([0-9a-f]\{16\}\)$/\1/p'; }
# expect <exit code> <text in the output> <command...>
expect() {
  local code=$1 text=$2 got=0
  shift 2
  "$@" >"$work/output" 2>&1 || got=$?
  [ "$got" = "$code" ] || { cat "$work/output" >&2; fail "exit code $got instead of $code: $*"; }
  grep -qF -- "$text" "$work/output" || { cat "$work/output" >&2; fail "no '$text' in the output of: $*"; }
}
# lines FOLDER: prints the number of shards in the folder's journal
lines() { if [ -e "$1/journal.jsonl" ]; then wc -l <"$1/journal.jsonl"; else echo 0; fi; }
wait_for_lines() { # folder count
  for _ in $(seq 3000); do
    [ "$(lines "$1")" -ge "$2" ] && return
    sleep 0.01
  done
  fail "no $2 shards after 30 s"
}
