#!/usr/bin/env bash
# Concurrent starts in one folder, with two seeds and --repair, on disk and in memory: one writer, and every other start
# reports the true reason.
#   SWINGBANK_ROUNDS=25 SWINGBANK_DISKS="/mnt/a /mnt/b" bash tests/mpi/starts_nightly.sh      (5 rounds of eight starts on each
# disk by default; other file systems as they are mounted)
source "$(dirname "$0")/common.bash"
rounds=${SWINGBANK_ROUNDS:-5}
make=("$generate" "$configs/ieee14_genrou_bus3.toml" --draws 100 --draws-per-shard 20 --progress none)
for seed in 1 2; do
  "${make[@]}" --seed $seed --out "$work/seed$seed" >/dev/null 2>&1
  hashes[seed]=$(hash_of "$work/seed$seed")
done
# one_round FOLDER: eight concurrent starts
one_round() {
  local i seed pids=() options
  rm -rf "$1"
  for i in 1 2 3 4 5 6 7 8; do
    seed=$((i % 2 + 1)) options=()
    if ((i > 6)); then options=(--repair); fi
    "${make[@]}" --seed $seed "${options[@]}" --out "$1" >"$work/start$i" 2>&1 &
    pids+=($!)
  done
  for i in 1 2 3 4 5 6 7 8; do
    if wait "${pids[i - 1]}"; then
      made=$((made + 1))
      grep -q "dataset ${hashes[i % 2 + 1]}" "$work/start$i" || { cat "$work/start$i"; fail "start $i ended with other data"; }
    else
      refused=$((refused + 1))
      grep -qE "dataset in use|a dataset of another config" "$work/start$i" || { cat "$work/start$i"; fail "a wrong reason"; }
    fi
  done
  "$verify" "$1" >"$work/log" 2>&1 || { cat "$work/log"; fail "the data of eight starts"; }
}
for disk in "$work" /dev/shm ${SWINGBANK_DISKS:-}; do
  made=0 refused=0 folder=$(mktemp -d -p "$disk")
  for ((round = 0; round < rounds; ++round)); do one_round "$folder/data"; done
  rm -rf "$folder"
  echo "$(stat -f -c %T "$disk"): $((8 * rounds)) starts: $made made or found the data whole, $refused were refused with the true reason"
done
