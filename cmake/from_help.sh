#!/usr/bin/env bash
# Generates man pages and bash completion from the programs' --help, so that neither is maintained by hand.
#   bash cmake/from_help.sh BIN VERSION OUT     writes OUT/man1/*.1 and OUT/completion.bash
set -euo pipefail
bin=$1 version=$2 out=$3

if ! command -v help2man >/dev/null; then
  echo "no man pages at cmake --install (help2man is missing): apt-get install help2man" >&2
  exit 1
fi
rm -rf "$out"
mkdir -p "$out/man1" "$out/help"
# research/ is not installed.
"$bin/swingbank" --help | sed '/^Benchmarks:/,/^$/d' >"$out/help/all"
# "  name  summary" under the headings of the groups
commands() { sed -n 's/^  \([a-z][a-z0-9-]*\)  *\(.*\)/\1\t\2/p' "$out/help/all"; }
[[ -n $(commands) ]] || { echo "no commands at $bin/swingbank --help (its list is empty): build all commands" >&2; exit 1; }

# help2man separates an option from its description by two spaces; CLI11 leaves one if the option fills its 30
# columns.
two_spaces() {
  awk '
    function say(line) {
      if (line ~ /^  -/ && substr(line, 29, 3) ~ /^[^ ] [^ ]$/) line = substr(line, 1, 29) " " substr(line, 30)
      print line
    }
    NR > 1 { if (substr($0, 1, 30) ~ /^ +$/) print held; else say(held) } # a meaning on the next line: nothing fills
    { held = $0 }
    END { say(held) }' "$1"
}

# page PROGRAM HELP SUMMARY SEE-ALSO: the options as --help describes them. help2man runs a program; here one that
# repeats the text obtained before, as some programs take a second to start.
page() {
  two_spaces "$out/help/$2" >"$out/help/said"
  printf '#!/bin/sh\ncat "%s"\n' "$out/help/said" >"$out/help/$1"
  chmod +x "$out/help/$1"
  printf '[files]\nThe example configs lie in the folder that\n.B swingbank configs\nprints.\n\n[see also]\n%s\n' "$4" >"$out/more"
  LC_ALL=C.UTF-8 help2man --no-info --include="$out/more" --version-string="$version" --name="$3" --manual=Swingbank \
    --source="swingbank $version" --output="$out/man1/$1.1" "$out/help/$1"
}

# "<command>\t<option>[\t<choices>]", a line for each option's name: "  --a,--b TEXT:{x,y} ...", "  --mode ENUM:value in {x->0} ..."
options_of() {
  awk -v command="$1" '
    /^  -/ {
      choices = ""
      if (match($0, /^  [^ ]+ [A-Z]+:(value in )?\{[^}]*\}/)) {
        choices = substr($0, RSTART, RLENGTH)
        sub(/^.*\{/, "", choices); sub(/\}$/, "", choices)
        gsub(/->[^,]*/, "", choices); gsub(/,/, " ", choices)
      }
      count = split($1, names, ",")
      for (i = 1; i <= count; i++) {
        sub(/\{.*/, "", names[i])
        print command "\t" names[i] "\t" choices
      }
    }' "$out/help/$1"
}

see_also=
while IFS=$'\t' read -r command summary; do
  "$bin/swingbank-$command" --help >"$out/help/$command" </dev/null
  page "swingbank-$command" "$command" "$summary" '.BR swingbank (1)'
  options_of "$command" >>"$out/options"
  see_also+=".BR swingbank-$command (1)"$'\n'
done < <(commands)
page swingbank all "power-plant model validation at scale" "$see_also"

{
  echo "# bash completion of swingbank $version, made from what its commands say to --help."
  echo "_swingbank_commands='$(commands | cut -f1 | tr '\n' ' ')'"
  echo 'declare -gA _swingbank_options=('
  awk -F'\t' '{ all[$1] = all[$1] " " $2 } END { for (c in all) printf "  [%s]='\''%s'\''\n", c, substr(all[c], 2) }' "$out/options" | sort
  echo ')'
  echo 'declare -gA _swingbank_choices=('
  awk -F'\t' '$3 != "" { printf "  ['\''%s %s'\'']='\''%s'\''\n", $1, $2, $3 }' "$out/options"
  echo ')'
  sed '1,/^# ---/d' "$(dirname "${BASH_SOURCE[0]}")/completion.bash"
} >"$out/completion.bash"
rm -r "$out/help" "$out/more" "$out/options"
