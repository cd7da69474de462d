#!/usr/bin/env bash
# Six of the injected failures of failing_trainings_nightly.sh.
SWINGBANK_INJECTIONS=66 SWINGBANK_STRIDE=13 exec bash "$(dirname "$0")/failing_trainings_nightly.sh"
