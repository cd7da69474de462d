# To be sourced after lib.bash: kills a run after a given time.
# shellcheck disable=SC2154,SC2034 # set by lib.bash; `pid` is for those who source this

# begin_and_kill WAY MS COMMAND...: starts the command in the background as its own process group, sets `pid`, and after
# MS milliseconds kills the process, one child, the whole group, or the group after stopping one child.
begin_and_kill() {
  local way=$1 at=$2 child
  shift 2
  setsid "$@" >"$work/log" 2>&1 &
  pid=$!
  sleep "$((at / 1000)).$(printf %03d $((at % 1000)))"
  child=$(pgrep -P $pid | head -1) || true
  case $way in
    child) kill -9 "${child:-$pid}" 2>/dev/null || true ;;
    group) kill -9 -- -$pid 2>/dev/null || true ;;
    stopped)
      kill -STOP "${child:-$pid}" 2>/dev/null || true
      sleep 0.1
      kill -9 -- -$pid 2>/dev/null || true
      ;;
    *) kill -9 $pid 2>/dev/null || true ;;
  esac
}
