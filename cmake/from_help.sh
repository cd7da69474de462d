#!/usr/bin/env bash
# Generates man pages, completion for bash, zsh and fish, and the JSON Schemas of files from the programs, so that none
# of these is maintained by hand.
#   bash cmake/from_help.sh BIN VERSION OUT OTHER...
# writes OUT/man1/*.1, OUT/{swingbank.bash,_swingbank,swingbank.fish}, OUT/schema/*.json, and OUT/alone/swingbank.1, which
# does not list OTHER: the programs of another component ("swingbank-train").
set -euo pipefail
bin=$1 version=$2 out=$3 others=" ${*:4} "

if ! command -v help2man >/dev/null; then
  echo "no man pages at cmake --install (help2man is missing): apt-get install help2man" >&2
  exit 1
fi
rm -rf "$out"
mkdir -p "$out/man1" "$out/alone" "$out/help"
# Removes the commands of research/, which are not installed.
"$bin/swingbank" --help | sed '/^Benchmarks:/,/^$/d' >"$out/help/all"
# Prints the groups' headings and, below each, lines "  name  summary".
commands() { sed -n 's/^  \([a-z][a-z0-9-]*\)  *\(.*\)/\1\t\2/p' "$out/help/all"; }
[[ -n $(commands) ]] || { echo "no commands at $bin/swingbank --help (its list is empty): build all commands" >&2; exit 1; }

# Separates an option from its description by two spaces, as help2man requires. CLI11 prints only one space if the
# option fills its 30 columns.
two_spaces() {
  awk '
    function say(line) {
      if (line ~ /^  -/ && substr(line, 29, 3) ~ /^[^ ] [^ ]$/) line = substr(line, 1, 29) " " substr(line, 30)
      print line
    }
    NR > 1 { if (substr($0, 1, 30) ~ /^ +$/) print held; else say(held) } # unchanged: description on the next line
    { held = $0 }
    END { say(held) }' "$1"
}

# page FOLDER PROGRAM HELP SUMMARY SEE-ALSO: writes the man page of a program. help2man must run a program; here it runs
# a script that prints the help obtained before, because some programs take a second to start.
page() {
  two_spaces "$out/help/$3" >"$out/help/said"
  printf '#!/bin/sh\ncat "%s"\n' "$out/help/said" >"$out/help/$2"
  chmod +x "$out/help/$2"
  printf '[files]\nThe example configs lie in the folder that\n.B swingbank configs\nprints.\n\n[see also]\n%s\n' "$5" >"$out/more"
  LC_ALL=C.UTF-8 help2man --no-info --include="$out/more" --version-string="$version" --name="$4" --manual=Swingbank \
    --source="swingbank $version" --output="$out/$1/$2.1" "$out/help/$2"
}

# Prints "<command>\t<option>\t<type>\t<choices>\t<meaning>", one line per option name. The type (TEXT, INT, ...) is "-"
# for a flag. The choices are those of "--a,--b TEXT:{x,y} ..." or "--mode ENUM:value in {x->0} ...", or "-". The
# meaning ends at its first semicolon.
options_of() {
  awk -v command="$1" '
    function write_option(    i, count, names) {
      gsub(/ \([^)]*\)?/, "", meaning); sub(/;.*/, "", meaning)
      count = split(option, names, ",")
      for (i = 1; i <= count; i++) print command "\t" names[i] "\t" type "\t" choices "\t" meaning
      option = ""
    }
    # take(PATTERN): removes the match of PATTERN from the start of rest, and returns the match
    function take(pattern,    found) {
      if (!match(rest, "^ ?" pattern)) return ""
      found = substr(rest, RSTART, RLENGTH)
      rest = substr(rest, RLENGTH + 1)
      return found
    }
    option != "" && substr($0, 1, 30) ~ /^ +$/ { sub(/^ +/, ""); meaning = meaning (meaning == "" ? "" : " ") $0; next }
    option != "" { write_option() }
    /^  -/ {
      rest = substr($0, 3)
      option = take("[^ {]+(\\{[^ ]*)?")
      gsub(/\{[^},]*\}?/, "", option)
      type = choices = take("(TEXT|ENUM|FLOAT|INT|UINT)[^ ]*( in (\\[[^]]*\\]|\\{[^}]*\\})[^ ]*)?")
      if (choices ~ /\{/) {
        sub(/^.*\{/, "", choices); sub(/\}.*$/, "", choices); gsub(/->[^,]*/, "", choices); gsub(/,/, " ", choices)
      } else
        choices = "-"
      sub(/^ /, "", type); sub(/[^A-Z].*/, "", type)
      if (type == "") type = "-"
      take("\\.\\.\\.( |$)"); take("REQUIRED"); take("Needs:( --[^ ]+)+")
      sub(/^ +/, "", rest)
      meaning = rest
    }
    END { if (option != "") write_option() }' "$out/help/$1"
}

# words_of COMMAND: prints "<command>\t<words>" if the first argument is one of several words, "KIND TEXT:{x,y}".
words_of() {
  sed -n '/^Positionals:/,/^$/s/^  [A-Za-z]* TEXT:{\([^}]*\)}.*/\1/p' "$out/help/$1" | head -n 1 | tr ',' ' ' | sed "s/^/$1\t/"
}

see_also='' see_also_alone=''
while IFS=$'\t' read -r command summary; do
  "$bin/swingbank-$command" --help >"$out/help/$command" </dev/null
  page man1 "swingbank-$command" "$command" "$summary" '.BR swingbank (1)'
  options_of "$command" >>"$out/options"
  words_of "$command" >>"$out/words"
  see_also+=".BR swingbank-$command (1)"$'\n'
  [[ $others == *" swingbank-$command "* ]] || see_also_alone+=".BR swingbank-$command (1)"$'\n'
done < <(commands)
page man1 swingbank all "power-plant model validation at scale" "$see_also"
# removes the lines of the other component's commands, and then each heading without lines
awk -v others="$others" '
  /^  [a-z]/ && index(others, " swingbank-" $1 " ") { next }
  /^[A-Z].*:$/ && $0 !~ /^Usage/ { heading = $0; next }
  heading != "" && /^$/ { heading = ""; next }
  heading != "" { print heading; heading = "" }
  { print }' "$out/help/all" >"$out/help/alone"
page alone swingbank alone "power-plant model validation at scale" "$see_also_alone"

# with_template FILE: writes OUT/FILE, which consists of standard input and the part of cmake/completion/FILE below "# ---"
with_template() {
  cat - <(sed '1,/^# ---/d' "$(dirname "${BASH_SOURCE[0]}")/completion/$1") >"$out/$1"
}

{
  echo "# bash completion of swingbank $version, generated from its commands' --help."
  echo "_swingbank_commands='$(commands | cut -f1 | tr '\n' ' ')'"
  echo 'declare -gA _swingbank_options=('
  awk -F'\t' '
    { all[$1] = all[$1] " " $2 }
    END { for (c in all) printf "  [%s]=\047%s\047\n", c, substr(all[c], 2) }' "$out/options" | sort
  echo ')'
  echo 'declare -gA _swingbank_choices=('
  awk -F'\t' '$4 != "-" { printf "  [\047%s %s\047]=\047%s\047\n", $1, $2, $4 }' "$out/options"
  awk -F'\t' '{ printf "  [\047%s %s\047]=\047%s\047\n", $1, $1, $2 }' "$out/words" # words after the command itself
  echo ')'
} | with_template swingbank.bash

quote="'"
{
  echo '#compdef swingbank'
  echo "# zsh completion of swingbank $version, generated from its commands' --help."
  echo 'typeset -ga _swingbank_commands=('
  commands | sed "s/$quote/$quote\\\\$quote$quote/g; s/^\\([^\t]*\\)\t/\\1:/; s/.*/  $quote&$quote/"
  echo ')'
  echo '# Prints the options of a command for _arguments.'
  printf '_swingbank_options() {\n  case $1 in\n'
  awk -F'\t' '
    FILENAME == ARGV[1] { words[$1] = $2; next }
    $1 != last {
      printf "%s    %s)\n      cat <<\047OPTIONS\047\n", last == "" ? "" : "OPTIONS\n      ;;\n", $1
      last = $1
      if ($1 in words) printf "1:word:(%s)\n", words[$1]
    }
    {
      meaning = $5
      gsub(/\\/, "\\\\", meaning); gsub(/\[/, "\\[", meaning); gsub(/\]/, "\\]", meaning)
      action = $4 != "-" ? "(" $4 ")" : $3 == "TEXT" ? "_files" : " "
      printf "*%s[%s]%s\n", $2, meaning, $3 == "-" ? "" : ":" tolower($3) ":" action
    }
    END { print "OPTIONS\n      ;;" }' "$out/words" "$out/options"
  printf '  esac\n}\n'
} | with_template _swingbank

{
  echo "# fish completion of swingbank $version, generated from its commands' --help."
  awk -F'\t' '{ printf "complete -c swingbank -n \047__swingbank_words %s\047 -x -a \047%s\047\n", $1, $2 }' "$out/words"
  { commands; cat "$out/options"; } | awk -F'\t' '
    function quoted(text) { gsub(/[\\\047]/, "\\\\&", text); return "\047" text "\047" }
    NF == 2 {
      printf "complete -c swingbank -n __swingbank_words -a %s -d %s\n", $1, quoted($2)
      printf "complete -c swingbank -n \047__swingbank_words help\047 -a %s -d %s\n", $1, quoted($2)
      next
    }
    {
      name = $2 ~ /^--/ ? "-l " substr($2, 3) : "-s " substr($2, 2)
      value = $4 != "-" ? " -x -a " quoted($4) : $3 == "-" ? "" : $3 == "TEXT" ? " -r -F" : " -x"
      printf "complete -c swingbank -n \047__swingbank_words %s\047 %s%s -d %s\n", $1, name, value, quoted($5)
    }'
} | with_template swingbank.fish
rm -r "$out/help" "$out/more" "$out/options" "$out/words"

"$bin/swingbank" schema --out "$out/schema"
