#!/usr/bin/env bash
# swingbank schema: configs/schema, the schemas against the examples, and mutations that schema and program refuse.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

"$swingbank" schema --out "$work/schema"
diff -r "$work/schema" "$SWINGBANK_SOURCE/configs/schema" >"$work/diff" ||
  fail "configs/schema is out of date: swingbank schema --out configs/schema ($(head -n 5 "$work/diff"))"
"$swingbank" schema | cut -d' ' -f1 | sort >"$work/kinds"
diff "$work/kinds" <(cd "$work/schema" && printf '%s\n' *.json | sed 's/\.json$//' | sort) || fail "kinds of the list"
"$swingbank" schema plant | cmp - "$work/schema/plant.json" || fail "schema plant on the terminal"
misused "unknown kind" "KIND" "$swingbank" schema plants

cp -r "$SWINGBANK_SOURCE/configs" "$work/configs"
/usr/bin/python3 "$(dirname "${BASH_SOURCE[0]}")/schema.py" "$swingbank" "$work/configs" \
  "$SWINGBANK_SOURCE"/configs/*/*.toml "$SWINGBANK_SOURCE"/configs/*/*/*.toml "$SWINGBANK_SOURCE/tests/validate/diagnose/dynawo_case_1.toml"
