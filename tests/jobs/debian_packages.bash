# Sourced by the tests of the Debian packages, after lib.bash.
# shellcheck disable=SC2154 # work is lib.bash's

# make_packages FOLDER: writes the packages of the build folder to FOLDER
make_packages() {
  local build
  build=$(cd "$SWINGBANK_BIN/.." && pwd)
  mkdir -p "$1"
  (cd "$1" && cpack --config "$build/CPackConfig.cmake" -G DEB -B "$1") >"$work/cpack" 2>&1 ||
    fail "cpack: $(tail -n 20 "$work/cpack")"
  rm -r "$1/_CPack_Packages"
}

# check PACKAGE-FILE: lintian finds nothing
check() {
  lintian --no-cfg --fail-on error,warning "$1" >"$work/lintian" 2>&1 || fail "lintian: $(cat "$work/lintian")"
  echo "ok: lintian: $(basename "$1")"
}

# first_comparison: the README's first example in the current folder; prints the comparison into $work/compare
first_comparison() {
  local example status=0
  cp -r "$(swingbank configs)" .
  read -r -a example < \
    <(sed -n 's/^swingbank compare \(--model .*\) --out comparison$/\1/p' "$SWINGBANK_SOURCE/README.md")
  ((${#example[@]} == 4)) || fail "the README's example is not found: ${example[*]}"
  # shellcheck disable=SC2068 # the pattern expands to the files
  swingbank compare ${example[@]} --out comparison >"$work/compare" 2>&1 || status=$?
  ((status == 3)) && [[ -s comparison/report.html ]]
}
