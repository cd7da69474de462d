#!/usr/bin/env bash
# Seven injected failures of failing_calls_nightly.sh, which cover every error and kind of run. Also five failures that
# once ended without the injected reason: out of memory while reading a number of the config (251), in a reply of rank 0
# (330) and in a group write (333), and an MPI-IO open that fails on one rank of two (312, 445).
SWINGBANK_INJECTIONS=49 SWINGBANK_STRIDE=8 SWINGBANK_ALSO='251 312 330 333 445' exec bash "$(dirname "$0")/failing_calls_nightly.sh"
