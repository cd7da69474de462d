#!/usr/bin/env bash
# A failure of one rank ends all ranks, and its reason is reported. If the other ranks waited forever, the time limit of
# one minute would fail the test.
source "$(dirname "$0")/common.bash"
config=$configs/ieee14_genrou_bus3.toml
on_two() { timeout -k 5 60 mpirun --oversubscribe -np 1 "$@"; }

# An exception outside of the collective error handling.
expect 1 "failure at rank 2 of 3 (only here)" \
  timeout -k 5 60 mpirun --oversubscribe -np 3 "$SWINGBANK_BIN/test_mpi_ranks" --gtest_filter='FailingRank.*' --gtest_brief=1

# Rank 1 has too little memory for its copy of the databank: 14 parameters of 20 million points are 2.2 GB.
options=("$config" --draws 20000000 --faults-per-point 1 --draws-per-shard 1000000 --progress none)
expect 1 "too little memory for the databank at rank 1" \
  on_two "$generate" "${options[@]}" --out "$work/memory" : -np 1 prlimit --as=1500000000 "$generate" "${options[@]}" --out "$work/memory"

# A full disk on one rank, in a folder whose name is no UTF-8.
odd=$work/$'m\xfcller'
options=("$config" --draws 400 --draws-per-shard 20 --progress none --out "$odd")
expect 1 "bytes for the file at" \
  on_two "$generate" "${options[@]}" --dedicated-master : -np 1 bash -c 'trap "" XFSZ; ulimit -f 200; exec "$@"' bash "$generate" "${options[@]}" --dedicated-master
expect 0 "400 draws" "$generate" "${options[@]}"

# An option given to one rank only.
expect 1 "--nonsense" on_two "$generate" "${options[@]}" : -np 1 "$generate" "${options[@]}" --nonsense
