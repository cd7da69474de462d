#!/usr/bin/env bash
# A dozen of the injected failures of failing_trainings_night.sh.
SWINGBANK_INJECTIONS=84 SWINGBANK_STRIDE=7 exec bash "$(dirname "$0")/failing_trainings_night.sh"
