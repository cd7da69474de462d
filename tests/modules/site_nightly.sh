#!/usr/bin/env bash
# Every page of the documentation site in a browser: none is wider than a phone's screen or loads anything from outside,
# and the search works without a server.
set -euo pipefail
cd "${SWINGBANK_SOURCE:?}"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
bash docs/site.sh "$work/site"
/usr/bin/python3 tests/modules/site_browser.py "$work/site"
