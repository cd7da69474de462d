# Starts the live page for tests; sourced after lib.bash.
model=$SWINGBANK_SOURCE/configs/plants/ieee14_bus2.toml
# serve RECORD...: starts the server in $work and waits for its address; sets $server and $url.
# shellcheck disable=SC2034,SC2154 # used by the tests; set by lib.bash
serve() {
  cd "$work" || exit
  "$swingbank" serve --model "$model" --records "$@" --power-only --out saved --quiet >url 2>log &
  server=$!
  for ((k = 0; k < 300; ++k)); do
    [[ -s url ]] && break
    sleep 0.1
  done
  url=$(<url)
  [[ $url =~ ^http://127\.0\.0\.1:[0-9]+/[0-9a-f]{32}/$ ]] || fail "the address is '$url': $(<log)"
}
