#!/usr/bin/env bash
# A file's namespace is its folder: swingbank::validate::fit in validate/fit and validate/fit/detail. Two rooms are what
# all others stand on and have their parent's name: base is swingbank, sim/core is swingbank::sim. A folder that holds
# rooms holds no source.
set -euo pipefail
cd "${SWINGBANK_SOURCE:?}"
failed=0
while read -r file; do
  room=${file%/*}
  room=${room%/detail}
  case $room in
    base) name=swingbank ;;
    sim/core) name=swingbank::sim ;;
    sim | mpi | train | validate | validate/blind)
      echo "$file stands in $room, which holds rooms: put it into one of them" >&2
      failed=1
      continue ;;
    *) name=swingbank::${room//\//::} ;;
  esac
  if grep -q '^namespace swingbank' "$file" && grep '^namespace swingbank' "$file" | grep -qvE "^namespace $name(::| \{)"; then
    echo "$file opens $(grep -m1 '^namespace swingbank' "$file") in place of $name" >&2
    failed=1
  fi
done < <(git ls-files --cached --others --exclude-standard -- 'base/*.?pp' 'sim/*.?pp' 'mpi/*.?pp' 'train/*.?pp' 'validate/*.?pp')
exit "$failed"
