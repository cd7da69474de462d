#!/usr/bin/env bash
# Parts of a report that a submission needs: nameplate, usability and signatures; errors of a nameplate.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
# shellcheck disable=SC2154 # set by verdict.bash
source "$(dirname "${BASH_SOURCE[0]}")/verdict.bash"

# without a nameplate all fields are reported as missing; a given field is on page, terminal and JSON
gives 3 '^Missing under \[nameplate\] of .*: owner, plant, unit, mva, kv, recorded, machine.manufacturer' compare --model "$bent"
cat "$bent" - >"$work/named.toml" <<'TOML'
[nameplate]
owner = "Ä <b> \"x\""
mva = 100
commissioned = "1998-11"
[nameplate.machine]
serial = "0815"
TOML
gives 3 '^Usability: ' compare --model "$work/named.toml"
for words in 'Ä &lt;b&gt; &quot;x&quot;' '100 MVA' '1998-11' '0815' '>missing<' 'Usability</h2>' '<section class="signatures">'; do
  grep -qF -- "$words" "$work/out/report.html" || fail "'$words' is not on the page"
done
fits_schema "$work/out/compare.json"
"$swingbank" export --model "$work/named.toml" --bus 2 | holds -q '^// Generator, serial number: 0815' || fail "export loses the nameplate"

# signatures appear in print only, not on the screen
if command -v chromium >/dev/null; then
  shown() {
    sed "s|</main>|</main><script>addEventListener('load', () => { const e = document.querySelector('.signatures'); \
document.body.innerText = 'shown:' + getComputedStyle(e).display + ';'; })</script>|; s|@media print|@media $1|" \
      "$work/out/report.html" >"$work/shown.html"
    chromium --headless --no-sandbox --disable-gpu --window-size=400,800 --dump-dom "file://$work/shown.html" 2>/dev/null | grep -o 'shown:[a-z]*;'
  }
  [[ $(shown print) == 'shown:none;' ]] || fail "signatures are on the screen: $(shown print)"
  [[ $(shown all) == 'shown:block;' ]] || fail "signatures are not in print: $(shown all)"
fi

# errors of a nameplate: all are reported at once, and nothing is written
rm -rf "$work/out"
cat "$bent" - >"$work/wrong.toml" <<'TOML'
[nameplate]
ownr = "A"
mva = -1
tested = "2026-02-30"
TOML
refuses "a faulty nameplate" 'unknown key nameplate.ownr at .*did you mean owner' "$swingbank" compare --model "$work/wrong.toml" --records "$one" --out "$work/out"
for words in 'nameplate.mva = -1' '2026-02-30'; do grep -q "$words" "$work/stderr" || fail "'$words' is not reported at once"; done
[[ ! -e $work/out ]] || fail "files left behind"
