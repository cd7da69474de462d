#!/usr/bin/env bash
# The file tables in the modules' READMEs match the head comments of the sources: a deleted file is reported and its
# row dropped, a new file gets a row. docs/architecture.svg shows the modules of the CMakeLists.txt files, without
# cycles.
set -euo pipefail
cd "${SWINGBANK_SOURCE:?}"
bash docs/readme_tables.sh --check
python3 docs/architecture.py --check
copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT
tar -cf - --exclude='*.cpp' docs/readme_tables.sh docs/architecture.py base sim mpi train validate research | tar -xf - -C "$copy"
# Two modules are sufficient for the test.
for folder in mpi sim train validate research; do mv "$copy/$folder/CMakeLists.txt" "$copy/$folder.all"; done
grep '^swingbank_module(sim/formats ' "$copy/sim.all" >"$copy/sim/CMakeLists.txt"
touch "$copy"/{mpi,train,validate,research}/CMakeLists.txt
# Without the sources, as in this copy, the tables are out of date.
if bash "$copy/docs/readme_tables.sh" --check 2>"$copy/said"; then
  echo "vanished sources went unnoticed" >&2
  exit 1
fi
grep -q 'sim/formats/README.md' "$copy/said"
printf '%s\n' '#pragma once' '// A clock (see J. Harrison, 1759). It is not used.' >"$copy/base/clock.hpp"
bash "$copy/docs/readme_tables.sh" >"$copy/said"
bash "$copy/docs/readme_tables.sh" --check
if grep -q '`psse_equipment`' "$copy/sim/formats/README.md"; then
  echo "a vanished source keeps its row" >&2
  exit 1
fi
last=$(sed '/^<!-- end of files -->$/q' "$copy/base/README.md" | tail -n 2 | head -n 1)
if [[ $last != '| `clock` | A clock (see J. Harrison, 1759) |' ]]; then
  echo "the row of a new header is: $last" >&2
  exit 1
fi
for folder in mpi sim train validate research; do mv "$copy/$folder.all" "$copy/$folder/CMakeLists.txt"; done
sed -i 's/^swingbank_module(sim\/core USES base)/swingbank_module(sim\/core USES base validate\/fleet_plant)/' "$copy/sim/CMakeLists.txt"
if python3 "$copy/docs/architecture.py" --check 2>"$copy/said"; then
  echo "a cycle of modules went unnoticed" >&2
  exit 1
fi
grep -q 'a dependency cycle at the swingbank_module lines' "$copy/said"
