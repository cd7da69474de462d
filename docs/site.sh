#!/usr/bin/env bash
# Builds the documentation site with MkDocs. Open OUT/index.html; no server is needed, and no page loads anything from
# outside.
#   bash docs/site.sh OUT
set -euo pipefail
out=${1:?"a folder is needed at OUT (the site is written there): bash docs/site.sh OUT"}
folder=$(cd "$(dirname "${BASH_SOURCE[0]}")/site" && pwd)
if ! command -v mkdocs >/dev/null || [[ ! -d /usr/share/mkdocs/themes/material ]]; then
  echo "no MkDocs with its theme Material at docs/site.sh (it renders the pages):" \
    "apt-get install mkdocs mkdocs-material" >&2
  exit 1
fi
if [[ -n $(ls -A "$out" 2>/dev/null) && ! -e $out/search/search_index.js ]]; then
  echo "other files at $out (only those of an earlier site are replaced): give an empty or new folder" >&2
  exit 1
fi
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python3 "$folder/pages.py" "$work"
mkdocs --quiet build --strict --config-file "$work/mkdocs.yml" --site-dir "$work/site"
# theme/disk_search.js loads the index as a script.
{
  printf 'take_search_index('
  cat "$work/site/search/search_index.json"
  printf ');\n'
} >"$work/site/search/search_index.js"
mkdir -p "$out"
find "$out" -mindepth 1 -delete
cp -r "$work/site/." "$out"
