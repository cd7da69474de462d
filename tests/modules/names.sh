#!/usr/bin/env bash
# A file's namespace is its folder: swingbank::validate::fit in validate/fit and validate/fit/detail. The two basic
# modules use their parent's namespace: base uses swingbank, sim/core uses swingbank::sim. A folder that contains
# modules contains no source itself. JSON is read through base/json.hpp, which alone includes the library.
set -euo pipefail
cd "${SWINGBANK_SOURCE:?}"
sources=('base/*.?pp' 'sim/*.?pp' 'mpi/*.?pp' 'train/*.?pp' 'validate/*.?pp' 'research/*.?pp')
failed=0

# module_of FILE: sets `module`, the module of the file
module_of() {
  module=${1%/*}
  module=${module%/detail}
}

while read -r file; do
  module_of "$file"
  case $module in
    sim | mpi | train | validate | research/blind)
      echo "$file stands in $module, which holds modules: put it into one of them" >&2
      failed=1 ;;
  esac
done < <(git ls-files --cached --others --exclude-standard -- "${sources[@]}")
while IFS=: read -r file opened; do
  module_of "$file"
  case $module in
    base) name=swingbank ;;
    sim/core) name=swingbank::sim ;;
    *) name=swingbank::${module//\//::} ;;
  esac
  if [[ $opened != "namespace $name "* && $opened != "namespace $name::"* ]]; then
    echo "$file opens $opened in place of $name" >&2
    failed=1
  fi
done < <(git grep --untracked '^namespace swingbank' -- "${sources[@]}")
if git grep --untracked -n '<nlohmann/json.hpp>' -- '*.?pp' '*.cmake' '*CMakeLists.txt' ':!base/json.hpp'; then
  echo "these include the library of JSON, which takes 1e95 for a whole number: include base/json.hpp" >&2
  failed=1
fi
exit "$failed"
