#!/usr/bin/env bash
# A dozen of the injected failures of failing_calls_night.sh: every error, every kind of run.
SWINGBANK_INJECTIONS=42 SWINGBANK_STRIDE=3 exec bash "$(dirname "$0")/failing_calls_night.sh"
