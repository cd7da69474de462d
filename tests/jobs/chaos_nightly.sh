#!/usr/bin/env bash
# Kills databank, train and cross-validate at times spread evenly over their duration: the process, one child, all at
# once, or all after one was stopped. After each kill, one more run must give the same result and network.
#   SWINGBANK_KILLS=200 bash tests/jobs/chaos_nightly.sh      (40 by default)
# shellcheck disable=SC2154,SC2034 # set by lib.bash; read by tiny_experiment
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
source "$(dirname "${BASH_SOURCE[0]}")/kill.bash"
source "$(dirname "${BASH_SOURCE[0]}")/tiny_experiment.bash"
source "$(dirname "${BASH_SOURCE[0]}")/same_training.bash"
kills=${SWINGBANK_KILLS:-40}
export OMP_NUM_THREADS=1
TINY_DRAWS=120 TINY_EPOCHS=3
tiny_experiment "$work"
"$swingbank" generate "$work/tiny_data.toml" --out "$work/data" --progress none >/dev/null 2>&1

# command KIND OUT: sets `run`
command() {
  case $1 in
    databank) run=("$swingbank" databank "$SWINGBANK_SOURCE/configs/datasets/ieee39_genrou.toml" --points 20000 --out "$2/databank.h5") ;;
    train) run=("$swingbank" cross-validate "$work/data" --experiment "$work/tiny.toml" --preset quick --network gru --fold 30 --out "$2") ;;
    *) run=("$swingbank" cross-validate "$work/data" --experiment "$work/tiny.toml" --preset quick --processes 2 --out "$2") ;;
  esac
}
declare -A lasts tried
for kind in databank train folds; do
  mkdir "$work/$kind"
  command $kind "$work/$kind"
  begin=$(date +%s%N)
  "${run[@]}" >"$work/log" 2>&1 || fail "$kind: $(cat "$work/log")"
  lasts[$kind]=$((($(date +%s%N) - begin) / 1000000)) # [ms]
  essence "$work/$kind" >"$work/$kind.whole"
  echo "$kind takes ${lasts[$kind]} ms"
done
for ((i = 0; i < kills; ++i)); do
  kinds=(databank train folds) ways=(process child group stopped)
  kind=${kinds[i % 3]} way=${ways[i / 3 % 4]} out=$work/run
  rm -rf "$out"
  mkdir "$out"
  command "$kind" "$out"
  at=$((lasts[$kind] * i / kills))
  begin_and_kill "$way" "$at" "${run[@]}"
  for ((wait = 0; wait < 600; ++wait)); do # children save and end, even on a busy machine
    pgrep -g $pid >/dev/null || break
    sleep 0.1
  done
  if pgrep -g $pid >/dev/null; then
    kill -9 -- -$pid
    fail "kill $i ($way of $kind at $at ms): processes lived on for a minute"
  fi
  wait $pid 2>/dev/null || true
  "${run[@]}" >"$work/log" 2>&1 || fail "kill $i ($way of $kind at $at ms): the next run: $(cat "$work/log")"
  essence "$out" | diff "$work/$kind.whole" - >"$work/log" || fail "kill $i ($way of $kind at $at ms): another result: $(cat "$work/log")"
  tried[$kind]=$((${tried[$kind]:-0} + 1))
done
for kind in "${!tried[@]}"; do echo "$kind: ${tried[$kind]} of ${tried[$kind]} kills end in the same result"; done
