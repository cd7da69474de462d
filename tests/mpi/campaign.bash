# Sourced after common.bash or lib.bash: a campaign of many items that can be interrupted, resumed and divided among
# several shells.
#   SWINGBANK_RESULTS=FILE    file with a line "ITEM OUTCOME WORDS..." for each finished item; these are not repeated
#   SWINGBANK_FROM, SWINGBANK_STRIDE    this shell's items: FROM, FROM + STRIDE, ...
#   SWINGBANK_GO_ON=1         a failed item is reported and recorded, and does not end the campaign
# The totals at the end count all lines of the file.
# shellcheck disable=SC2154,SC2034 # set by common.bash or lib.bash; read by campaigns
results=${SWINGBANK_RESULTS:-$work/results}
touch "$results"
from=${SWINGBANK_FROM:-0} stride=${SWINGBANK_STRIDE:-1}

is_done() { grep -q "^$1 " "$results"; }
# keep ITEM OUTCOME WORDS...: records an item in one write, so that parallel shells may append too
keep() { echo "$*" >>"$results"; }

# wrong WORDS: reports a failure of the current item and shows $work/log
went_wrong=''
wrong() {
  went_wrong=$*
  echo "WRONG: $*" >&2
  sed 's/^/  | /' "$work/log" 2>/dev/null | tail -12 >&2
  [ -n "${SWINGBANK_GO_ON:-}" ] || exit 1
}

# report_campaign N: reports how many of N items are done (parallel shells may do the others); fails if one failed
report_campaign() {
  local made wrongs
  made=$(wc -l <"$results")
  wrongs=$(awk '$2 == "wrong"' "$results" | wc -l)
  echo "$made of $1 done, $((made - wrongs)) as required, $wrongs failed"
  if ((wrongs > 0)); then awk '$2 == "wrong"' "$results" >&2; fi
  ((wrongs == 0))
}
