#!/usr/bin/env bash
# swingbank schema: the schemas against the examples, and mutations that schema and program refuse.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

cp -r "$SWINGBANK_SOURCE/configs" "$work/configs"
"$swingbank" schema --out "$work/configs/schema"
"$swingbank" schema | cut -d' ' -f1 | sort >"$work/kinds"
diff "$work/kinds" <(cd "$work/configs/schema" && printf '%s\n' *.json | sed 's/\.json$//' | sort) || fail "kinds of the list"
"$swingbank" schema plant | cmp - "$work/configs/schema/plant.json" || fail "schema plant on the terminal"
misused "unknown kind" "KIND" "$swingbank" schema plants

/usr/bin/python3 "$(dirname "${BASH_SOURCE[0]}")/schema.py" "$swingbank" "$work/configs" \
  "$work"/configs/*/*.toml "$work"/configs/*/*/*.toml
