# Functions with which scripts run long programs; to be sourced. After SIGUSR1, such a program saves its state and ends
# with exit code 2: "saved, run again to continue".

stop_wanted=0
stop_signal='' # last stop signal
child=''

# Stores a stop signal, even if it arrives between two programs, and forwards it as SIGUSR1. Programs run in the
# background, because bash runs a trap only between commands or in `wait`.
on_stop_signal() {
  stop_wanted=1 stop_signal=$1
  if [[ -n $child ]]; then kill -USR1 "$child" 2>/dev/null || true; fi
}
for stop_signal in USR1 TERM INT; do
    # shellcheck disable=SC2064 # the trap needs the name of this signal
  trap "on_stop_signal $stop_signal" "$stop_signal"
done
stop_signal=''

launcher_patience=${SWINGBANK_LAUNCHER_PATIENCE:-30} # [s]

# is_lost LAUNCHER: true if all child processes of the launcher have ended but it still runs. Also true if one of them
# is stopped and the others wait for it. Sets `lost` to the process to kill: the launcher, or the stopped process.
is_lost() {
  lost=$1
  local process state dead=0 all
  read -ra all < <(cat "/proc/$1"/task/*/children 2>/dev/null) || true
  for process in ${all[@]+"${all[@]}"}; do
    state=$(sed -n 's/^State:[[:space:]]*\(.\).*/\1/p' "/proc/$process/status" 2>/dev/null) || true
    case ${state:-Z} in
      T) lost=$process && return 0 ;;
      Z | X) dead=$((dead + 1)) ;;
    esac
  done
  ((dead > 0 && dead == ${#all[@]}))
}

# watch_launcher LAUNCHER: ends OpenMPI 4.1's launcher, which may hang if a rank dies during startup.
watch_launcher() {
  local seconds=0 lost
  while sleep 1 && kill -0 "$1" 2>/dev/null; do
    if is_lost "$1"; then seconds=$((seconds + 1)); else seconds=0; fi
    if ((seconds >= launcher_patience)); then
      echo "a process killed at $lost (it was stopped for $seconds s while other processes waited, or it is a" \
        "launcher that outlived its processes): finished work is safe; run the same command again to continue" >&2
      kill -KILL "$lost" 2>/dev/null || true
      seconds=0
    fi
  done
}

# run_saving PROGRAM...: runs the program, forwards stop signals as SIGUSR1, and returns its exit code. A launcher that
# receives a signal during startup dies (mpirun: exit code 244). This counts as "saved" too, because finished shards and
# checkpoints are on the disk at any time.
run_saving() {
  local status before stopped=0 watcher
  if ((stop_wanted)); then return 2; fi
  "$@" &
  child=$!
    watch_launcher "$child" 9>&- & # closes 9, the lock of a script: the sleep would hold the lock for another second
  watcher=$!
  while :; do
    before=$stop_wanted status=0
    stop_wanted=0
    wait "$child" || status=$?
    if ((!stop_wanted)); then
      stop_wanted=$before
      break
    fi
        stopped=1 # a signal interrupted `wait`; the program may still be saving
  done
  child=''
  kill "$watcher" 2>/dev/null || true
  wait "$watcher" 2>/dev/null || true
  if ((stopped && status > 2)); then status=2; fi
  return "$status"
}
