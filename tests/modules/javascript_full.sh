#!/usr/bin/env bash
# The pages' JavaScript under ESLint's recommended rules. Node is no dependency of Swingbank: without it, or without
# npm's registry, the test passes and says so.
set -euo pipefail
cd "$SWINGBANK_SOURCE"

sources=(jobs/page/*.js validate/report/assets/*.js)
skip() {
  echo "ESLint was not run ($1): ${sources[*]} are unchecked"
  exit 0
}
[[ -f ${sources[0]} ]] || { echo "no JavaScript in $PWD" >&2; exit 1; }
command -v npm >/dev/null || skip "no npm"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
npm install --silent --no-audit --no-fund --prefix "$work" eslint@9 @eslint/js@9 globals@15 >"$work/log" 2>&1 ||
  skip "npm cannot install it: $(tail -n 1 "$work/log")"
# ESLint looks for the config's packages beside the config, and checks files below the folder where it runs.
cp -r --parents "${sources[@]}" "$work"
cp tests/modules/eslint.config.mjs "$work"
cd "$work"
node_modules/.bin/eslint --max-warnings 0 "${sources[@]}"
echo "var unused = 1;" >>"${sources[0]}"
! node_modules/.bin/eslint "${sources[0]}" >/dev/null || { echo "ESLint does not find an unused variable" >&2; exit 1; }
