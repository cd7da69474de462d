#!/usr/bin/env bash
# cross-validate killed by SIGKILL: its training processes save a checkpoint and end, and release the folder for the
# next start.
# shellcheck disable=SC2154 # set by lib.bash
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
TINY_EPOCHS=100000
source "$(dirname "${BASH_SOURCE[0]}")/bad_input_train.bash"

"$swingbank" cross-validate "$data" --experiment "$experiment" --out "$out" --processes 2 >"$work/log" 2>&1 &
parent=$!
children=()
for ((i = 0; i < 300 && ${#children[@]} < 2; ++i)); do
  sleep 0.1
  mapfile -t children < <(pgrep -P "$parent")
done
((${#children[@]} == 2)) || fail "no two processes: $(cat "$work/log")"
sleep 1
kill -KILL "$parent"
wait "$parent" 2>/dev/null || true
for ((i = 0; i < 300; ++i)); do
  kill -0 "${children[0]}" 2>/dev/null || kill -0 "${children[1]}" 2>/dev/null || break
  sleep 0.1
done
if kill -0 "${children[@]}" 2>/dev/null; then
  kill -KILL "${children[@]}"
  fail "the training processes continue after their parent was killed"
fi
for fold in 30 31; do
  [[ -e $out/checkpoints/V-gru-quick-seed1-gen$fold.checkpoint ]] || fail "no checkpoint of fold $fold: $(tail "$work/log")"
done
echo "ok: killed: checkpoints of both folds exist"
