# To be sourced after common.bash or lib.bash: a campaign of many items that may be broken off, gone on with, and divided
# among several shells.
#   SWINGBANK_RESULTS=FILE    keeps a line "ITEM OUTCOME WORDS..." of each that is done; those are not done again
#   SWINGBANK_FROM, SWINGBANK_STRIDE    this shell's items: FROM, FROM + STRIDE, ...
#   SWINGBANK_GO_ON=1         an item that goes wrong is told and kept, and does not end the campaign
# The figures at the end are those of all lines of the file.
# shellcheck disable=SC2154,SC2034 # what common.bash or lib.bash sets; what campaigns read
results=${SWINGBANK_RESULTS:-$work/results}
touch "$results"
from=${SWINGBANK_FROM:-0} stride=${SWINGBANK_STRIDE:-1}

is_done() { grep -q "^$1 " "$results"; }
# keep ITEM OUTCOME WORDS...: one write, so that shells beside this one may append too
keep() { echo "$*" >>"$results"; }

# wrong WORDS: of the item at hand; what $work/log holds is shown
went_wrong=''
wrong() {
  went_wrong=$*
  echo "WRONG: $*" >&2
  sed 's/^/  | /' "$work/log" 2>/dev/null | tail -12 >&2
  [ -n "${SWINGBANK_GO_ON:-}" ] || exit 1
}

# tell_campaign N: tells how many of N items are done (others may be with shells beside this one); fails if one went wrong
tell_campaign() {
  local made wrongs
  made=$(wc -l <"$results")
  wrongs=$(awk '$2 == "wrong"' "$results" | wc -l)
  echo "$made of $1 done, $((made - wrongs)) as promised, $wrongs otherwise"
  if ((wrongs > 0)); then awk '$2 == "wrong"' "$results" >&2; fi
  ((wrongs == 0))
}
