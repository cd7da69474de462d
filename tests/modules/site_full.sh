#!/usr/bin/env bash
# The documentation site is built without a warning; its pages show what GitHub shows, and no link is broken. A broken
# link is refused. site_nightly.sh opens every page in a browser.
set -euo pipefail
cd "${SWINGBANK_SOURCE:?}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() {
  echo "FAILED: $*" >&2
  exit 1
}

bash docs/site.sh "$work/site" >"$work/log" 2>&1 || fail "docs/site.sh: $(cat "$work/log")"
[[ ! -s $work/log ]] || fail "docs/site.sh gives a warning: $(cat "$work/log")"
/usr/bin/python3 tests/modules/site_pages.py "$work/site" || fail "pages of the site"

# Another build replaces the site; other files are never replaced.
bash docs/site.sh "$work/site" || fail "second build"
mkdir "$work/mine"
echo mine >"$work/mine/file"
! bash docs/site.sh "$work/mine" 2>"$work/log" || fail "a folder of other files was replaced"
grep -q "^other files at $work/mine (" "$work/log" || fail "other files: $(cat "$work/log")"
[[ $(cat "$work/mine/file") == mine ]] || fail "another file was replaced"

mkdir -p "$work/tree/docs/site"
cp docs/site/pages.py "$work/tree/docs/site"
printf '# Home\n\nSee [docs](docs/README.md), and\n[a](none.md) and `[code](code.md)`.\n' >"$work/tree/README.md"
printf '# Map\n\n[picture](../none.png)\n' >"$work/tree/docs/README.md"
! /usr/bin/python3 "$work/tree/docs/site/pages.py" "$work/out" 2>"$work/log" || fail "broken links were accepted"
diff - "$work/log" <<'LINKS' || fail "wrong report of broken links"
broken link none.md at README.md:4 (no such file): correct the path
broken link ../none.png at docs/README.md:3 (no such file): correct the path
LINKS
[[ ! -e $work/out ]] || fail "files were written in spite of broken links"
