#!/usr/bin/env bash
# Writes the tables of dependencies and files into each module's README.md.
#   bash docs/readme_tables.sh [--check]
#     --check  changes nothing; exits with 1 and names each README that is out of date
# Between `<!-- uses -->` and `<!-- end of uses -->`: the modules named in its swingbank_module() line.
# Between `<!-- files -->` and `<!-- end of files -->`: one row per file, for each header and for each source without a
# header of the same name. A row contains the first sentence of the file's head comment, or an effect's name and title.
# The order of the rows follows the data flow, so the script keeps it. New files are appended, deleted ones removed.
# shellcheck disable=SC2016 # backticks are Markdown here
set -euo pipefail
shopt -s nullglob
cd "$(dirname "${BASH_SOURCE[0]}")/.."
check=0
case ${1-} in
  '') ;;
  --check) check=1 ;;
  *) echo "unknown option at '$1' (docs/readme_tables.sh accepts --check only): remove it" >&2; exit 1 ;;
esac
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The words of each swingbank_module() call of a CMakeLists.txt, in one line.
awk 'FNR == 1 { text = "" }
  /^swingbank_module\(/ { text = " " }
  text != "" { sub(/#.*/, ""); text = text " " $0 }
  text ~ /\)/ { gsub(/swingbank_module\(|\)/, "", text); $0 = text; $1 = $1; print; text = "" }' \
  base/CMakeLists.txt {sim,mpi,train,validate,research}/CMakeLists.txt >"$work/modules"

# uses MODULE: prints the modules that it names, as links.
uses() {
  awk -v module="$1" '
    function link(other) { return "[" other "](" up other "/README.md)" }
    $1 == module {
      up = module
      gsub(/[^\/]+/, "..", up)
      up = up "/"
      for (i = 2; i <= NF; ++i)
        if ($i ~ /^(USES|INSIDE|LINK|SOURCES|KIND)$/) key = $i
        else if (key == "USES") public = public (public ? ", " : "") link($i)
        else if (key == "INSIDE") inside = inside (inside ? ", " : "") link($i)
      print "Public dependencies: " (public ? public : "none") "." (inside ? " Private dependencies: " inside "." : "")
    }' "$work/modules"
}

# files MODULE: prints its files without extension, those of detail/ last.
files() {
  local path
  for path in "$1"/*.hpp "$1"/*.cpp "$1"/detail/*.hpp "$1"/detail/*.cpp; do
    if [[ $path == *.cpp && -e ${path%.cpp}.hpp ]]; then continue; fi
    path=${path#"$1"/}
    printf '%s\n' "${path%.*}"
  done
}

# with_sentence: appends to each input path a tab, and the name and title of an effect or the first sentence of the head comment.
# A full stop in parentheses or after an initial does not end the sentence.
with_sentence() {
  awk '
    function first_sentence(s,   i, c, depth) {
      for (i = 1; i < length(s); ++i) {
        c = substr(s, i, 1)
        if (c == "(") ++depth
        if (c == ")") --depth
        if (c == "." && !depth && substr(s, i + 1, 2) ~ /^ [A-Z"(]/ && substr(s, i - 2, 2) !~ /[ .][A-Z]/)
          return substr(s, 1, i - 1)
      }
      sub(/[.:]$/, "", s)
      return s
    }
    function as_cell(s,   i, c, cell, code) { # escapes Markdown markup outside `code`
      for (i = 1; i <= length(s); ++i) {
        c = substr(s, i, 1)
        if (c == "`") code = !code
        cell = cell (c == "|" || (!code && c ~ /[<*]/) ? "\\" c : c)
      }
      return cell
    }
    function quoted(declared, word,   s) { # the string after `word =`
      if (!match(declared, word " = \"[^\"]*\"")) return ""
      s = substr(declared, RSTART, RLENGTH)
      gsub(/^[^"]*"|"$/, "", s)
      return s
    }
    function sentence_of(path, effect,   line, n, text, behind, inside, declared) {
      for (n = 1; (getline line < path) > 0; ++n) {
        if (n == 1 && line ~ /^#pragma once/) continue
        if (!behind && line ~ /^\/\/ ?[^ ]/) {
          sub(/^\/\/ ?/, "", line)
          text = text (text ? " " : "") line
          continue
        }
        behind = 1
        if (!effect) break
        if (line ~ /^  static constexpr std::string_view( name = |$)/) inside = 1
        if (!inside) continue
        sub(/^ +/, "", line)
        declared = declared " " line
        if (line ~ /;/) break
      }
      close(path)
      gsub(/= +"/, "= \"", declared)
      gsub(/" +"/, "", declared)
      return quoted(declared, "title") ? quoted(declared, "name") ": " quoted(declared, "title") : first_sentence(text)
    }
    { print $0 "\t" as_cell(sentence_of($0, $0 ~ /^sim\/effects\// && $0 !~ /\/detail\//)) }'
}

# table MODULE: prints the table of its files.
table() {
  local name file sentence
  files "$1" >"$work/present"
  sed -n '/^<!-- files -->$/,/^<!-- end of files -->$/s/^| `\([^`]*\)` |.*/\1/p' "$1/README.md" >"$work/listed"
  printf '%s\n' '| file | content |' '|---|---|'
  { grep -Fxf "$work/present" "$work/listed" || true; grep -vFxf "$work/listed" "$work/present" || true; } |
    while read -r name; do
      file=$1/$name.hpp
      [[ -e $file ]] || file=$1/$name.cpp
      printf '%s\n' "$file"
    done | with_sentence |
    while IFS=$'\t' read -r file sentence; do
      if [[ -z $sentence ]]; then
        echo "no head comment at $file (the module's table shows its first sentence): describe the file in a first sentence" >&2
        return 1
      fi
      name=${file#"$1"/}
      printf '| `%s` | %s |\n' "${name%.*}" "$sentence"
    done
}

# updated_readme MODULE: prints its README with both parts up to date.
updated_readme() {
  uses "$1" >"$work/uses"
  table "$1" >"$work/files"
  awk -v folder="$work" '
    /^<!-- (uses|files) -->$/ {
      print
      part = folder "/" $2
      while ((getline line < part) > 0) print line
      skip = 1
    }
    /^<!-- end of (uses|files) -->$/ { skip = 0 }
    !skip' "$1/README.md"
}

failed=0
while read -r module _; do
  readme=$module/README.md
  for mark in uses files; do
    if ! grep -qx -e "<!-- $mark -->" "$readme" || ! grep -qx -e "<!-- end of $mark -->" "$readme"; then
      echo "no '<!-- $mark -->' ... '<!-- end of $mark -->' at $readme (each module has one): write both lines" >&2
      exit 1
    fi
  done
  updated_readme "$module" >"$work/README.md"
  if cmp -s "$work/README.md" "$readme"; then continue; fi
  if ((check)); then
    echo "out of date at $readme (its dependencies or the head comments of its files have changed): run bash docs/readme_tables.sh" >&2
    failed=1
  else
    cp "$work/README.md" "$readme"
    echo "written: $readme"
  fi
done <"$work/modules"
exit "$failed"
