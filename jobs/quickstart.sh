#!/usr/bin/env bash
# Leads from a bare Debian 12 to result tables: installs, builds, simulates events of the IEEE 39-bus system, trains
# and tests one network for each generator left out, and writes the tables.
#   bash jobs/quickstart.sh [--out FOLDER]     (default out/quickstart)
# If it is started again, it continues where it stopped.
set -euo pipefail

source_folder=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
out=$source_folder/out/quickstart
while (($#)); do
  case $1 in
    --out) out=$(realpath -m "${2:?--out needs a folder}"); shift 2 ;;
    -h | --help) sed -n '2,5p' "$0"; exit 0 ;;
    *) echo "unknown option at '$1' (jobs/quickstart.sh has no such option): run it with --help" >&2; exit 1 ;;
  esac
done

bash "$source_folder/jobs/setup.sh"
started=$SECONDS
bash "$source_folder/jobs/run_experiment.sh" --experiment "$source_folder/configs/experiments/ieee39_gencls.toml" \
  --preset quick --out "$out"
printf '\n%s\n' "done in $(((SECONDS - started + 59) / 60)) min after the build"
echo "tables: $out/tables/tables.html (open it in a browser)"
