#!/usr/bin/env bash
# Group writing and collective reading with five ranks.
source "$(dirname "$0")/common.bash"
ranks 5 "$SWINGBANK_BIN/test_mpi_ranks" --gtest_filter='Ranks.*' --gtest_brief=1
