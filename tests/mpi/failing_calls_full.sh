#!/usr/bin/env bash
# A dozen of the injected failures of failing_calls_night.sh, every error, every kind of run; and those of a campaign of 500
# that once ended without their reason: memory while a number of the config is read (251), while rank 0 answers (330) and while
# a group writes (333), and an open of MPI-IO that fails on one rank of two (312, 445).
SWINGBANK_INJECTIONS=42 SWINGBANK_STRIDE=3 SWINGBANK_ALSO='251 312 330 333 445' exec bash "$(dirname "$0")/failing_calls_night.sh"
