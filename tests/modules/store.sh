#!/usr/bin/env bash
# Programs that read a dataset need no MPI, because mpi/store makes no MPI call. Both its sources and its object code
# are checked.
set -euo pipefail
cd "${SWINGBANK_SOURCE:?}"
failed=0
if grep -rn 'MPI_' mpi/store; then
  echo "mpi/store calls MPI: move collective operations to mpi/ranks" >&2
  failed=1
fi
find_library() { find "${SWINGBANK_BIN:?}/.." -name "libswingbank_mpi_$1.a" -print -quit; }
calls() {
  local library
  library=$(find_library "$1")
  [ -n "$library" ] || { echo "no library of mpi/$1 was built" >&2; exit 1; }
  nm -u "$library" | grep -c ' MPI_' || true
}
if [ "$(calls ranks)" -eq 0 ]; then
  echo "no MPI call is found in mpi/ranks either: this search finds nothing" >&2
  failed=1
fi
if [ "$(calls store)" -ne 0 ]; then
  echo "the compiled mpi/store calls MPI" >&2
  failed=1
fi
exit "$failed"
