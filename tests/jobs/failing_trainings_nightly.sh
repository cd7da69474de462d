#!/usr/bin/env bash
# One file call or memory allocation fails in a training, at any position. The file calls are those on checkpoint,
# network and result, or those on the dataset. The run ends in time, complete with the same result or with the injected
# error. One more run gives the same result.
#   SWINGBANK_INJECTIONS=300 bash tests/jobs/failing_trainings_nightly.sh      (90 by default)
# shellcheck disable=SC2154,SC2034 # set by lib.bash and failing_calls.bash; read by tiny_experiment
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
source "$(dirname "${BASH_SOURCE[0]}")/tiny_experiment.bash"
source "$(dirname "${BASH_SOURCE[0]}")/same_training.bash"
source "$(dirname "${BASH_SOURCE[0]}")/../mpi/campaign.bash"
source "$(dirname "${BASH_SOURCE[0]}")/../mpi/failing_calls.bash"
injections=${SWINGBANK_INJECTIONS:-90}
export OMP_NUM_THREADS=1
TINY_DRAWS=60
tiny_experiment "$work"
sed -e '/^folds/d' -e 's/^split = .*/split = "by-databank-point"/' -e 's/^table = .*/table = "IV"/' "$work/tiny.toml" >"$work/split.toml"
"$swingbank" generate "$work/tiny_data.toml" --out "$work/data" --progress none >/dev/null 2>&1

# command KIND: sets `run` to a program without the dispatcher, so that no call is counted twice
command() {
  case $1 in
    train) run=("$SWINGBANK_BIN/swingbank-train" "$work/data" --experiment "$work/split.toml") ;;
    fold) run=("$SWINGBANK_BIN/swingbank-cross-validate" "$work/data" --experiment "$work/tiny.toml" --fold 30) ;;
    folds) run=("$SWINGBANK_BIN/swingbank-cross-validate" "$work/data" --experiment "$work/tiny.toml" --processes 2) ;;
  esac
  run+=(--out "$work/out")
}
# If an allocation fails before main or in LibTorch's initialisation, no message is possible.
read -r _ early < <(counts 0 "$work/none" "$SWINGBANK_BIN/swingbank-train" --experiment "$work/split.toml" --print table)
declare -A calls
for kind in train fold folds; do
  command $kind
  for under in out data; do
    rm -rf "$work/out"
    read -r calls[$kind$under] calls[${kind}memory] < <(counts 0 "$work/$under" "${run[@]}")
  done
  essence "$work/out" >"$work/$kind.whole"
  if [ $kind = folds ]; then calls[foldsout]=${calls[foldout]}; fi # its child processes end without writing a count
  echo "$kind: ${calls[${kind}out]} calls on its own files, ${calls[${kind}data]} on the dataset's, ${calls[${kind}memory]} allocations"
done
kinds=(train fold folds) unders=(out out data) errors=(5 28 2 4 122)
begin_item() { rm -rf "$work/out"; }
check_item() {
  if [ "$ended" = told ]; then
    cp "$work/log" "$work/before"
    "${run[@]}" >"$work/log" 2>&1 || wrong "the next run after $what: $(cat "$work/before")"
  fi
  essence "$work/out" | diff "$work/$kind.whole" - >"$work/log" || wrong "another result after $what"
}
for ((i = from; i < injections; i += stride)); do
  if is_done $i; then continue; fi
  kind=${kinds[i % 3]} under=${unders[i / 3 % 3]} error=${errors[i / 9 % 5]}
  first=0 of=${calls[$kind$under]}
  if ((i / 3 % 6 == 4)); then error=memory first=$early of=$((calls[${kind}memory] - early)); fi
  command "$kind" # sets `run`
  strike $i "$error" 0 "$work/$under" "$of" "$first" "${run[@]}"
done
report_failures "$injections"
