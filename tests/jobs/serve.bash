# Starts the live page for tests; sourced after lib.bash.
# shellcheck disable=SC2154 # set by lib.bash
model=$work/ieee14_bus2.toml
sed 's/^\[record\]$/&\nbase_kv = 69.0/' "$SWINGBANK_SOURCE/configs/plants/ieee14_bus2.toml" >"$model"
# serve RECORD...: starts the server in $work and waits for its address; sets $server and $url.
# shellcheck disable=SC2034,SC2154 # used by the tests; set by lib.bash
serve() {
  cd "$work" || exit
  # The server ends with this test, also if it fails.
  setpriv --pdeathsig TERM "$swingbank" serve --model "$model" --records "$@" --power-only --out saved --quiet >url 2>log &
  server=$!
  for ((k = 0; k < 300; ++k)); do
    [[ -s url ]] && break
    sleep 0.1
  done
  url=$(<url)
  [[ $url =~ ^http://127\.0\.0\.1:[0-9]+/[0-9a-f]{32}/$ ]] || fail "the address is '$url': $(<log)"
}
