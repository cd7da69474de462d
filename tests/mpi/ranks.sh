#!/usr/bin/env bash
# Group writing and collective reading with one, three and five ranks.
source "$(dirname "$0")/common.bash"
for n in 1 3 5; do ranks "$n" "$SWINGBANK_BIN/test_mpi_ranks" --gtest_filter='Ranks.*' --gtest_brief=1; done
