#!/usr/bin/env bash
# Group writing and collective reading with one and three ranks; ranks_full.sh has five.
source "$(dirname "$0")/common.bash"
for n in 1 3; do ranks "$n" "$SWINGBANK_BIN/test_mpi_ranks" --gtest_filter='Ranks.*' --gtest_brief=1; done
