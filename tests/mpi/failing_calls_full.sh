#!/usr/bin/env bash
# A dozen of the injected failures of failing_calls_night.sh, every error, every kind of run; and those of a campaign of 500
# that once ended without their reason: memory while a number of the config is read (251), memory while rank 0 answers
# (330), an open of MPI-IO that fails on one rank of two (445).
SWINGBANK_INJECTIONS=42 SWINGBANK_STRIDE=3 SWINGBANK_ALSO='251 330 445' exec bash "$(dirname "$0")/failing_calls_night.sh"
