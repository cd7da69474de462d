#!/usr/bin/env bash
# No command destroys an input: an output that equals an input is refused at the start, and every input stays
# unchanged.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"

configs=$SWINGBANK_SOURCE/configs
cd "$work"
cp "$configs/networks/ieee14_genrou.raw" n.raw
cp "$configs/networks/ieee14_genrou.dyr" n.dyr
cp "$configs/records/record-example/avr_ev1.csv" p.csv
mkdir calibration own
cp "$configs/plants/ieee14_bus2.toml" calibration/model.toml
cp "$configs/plants/ieee14_bus2.toml" own/model.toml
cp "$configs/plants/ieee14_bus2.toml" m.toml
mkdir bin
printf '#!/bin/sh\nexit 1\n' >bin/chromium
chmod +x bin/chromium
PATH=$work/bin:$PATH
sums=$(find . -type f -print0 | sort -z | xargs -0 sha256sum)

# kept NAME PATTERN COMMAND...: refused, and no file was changed, added or removed
kept() {
  refuses "$@"
  rm -f stdout stderr
  diff <(echo "$sums") <(find . -type f -print0 | sort -z | xargs -0 sha256sum) || fail "$1: a file was changed, added or removed"
}

kept "calibrate with its default folder" 'at --out' "$swingbank" calibrate --model calibration/model.toml --records p.csv \
  --power-only --draws 0 --starts 0
kept "calibrate into the model's folder" 'own/model.toml is an input' "$swingbank" calibrate --model own/model.toml \
  --records p.csv --out own --power-only
kept "add into the model's folder" 'at --out' "$swingbank" add SEXS --model own/model.toml --records p.csv --out own
kept "compare --pdf over a record" 'at --pdf' "$swingbank" compare --model m.toml --records p.csv --pdf p.csv --out new
kept "compare --pdf over the model" 'at --pdf' "$swingbank" compare --model m.toml --records p.csv --pdf ./own/../m.toml --out new
kept "plant over the .dyr" 'at --out' "$swingbank" plant --raw n.raw --dyr n.dyr --bus 2 --out n.dyr
kept "plant over the .raw" 'at --out' "$swingbank" plant --raw n.raw --dyr n.dyr --bus 2 --out ./n.raw
kept "export over the plant file" 'at --out' "$swingbank" export --model m.toml --bus 2 --out m.toml
kept "simulate --changes over the .dyr" 'at --changes' "$swingbank" simulate --raw n.raw --dyr n.dyr --changes n.dyr \
  --t-end 0.1 --out run.csv
kept "simulate writes two outputs into one file" 'named twice' "$swingbank" simulate --raw n.raw --dyr n.dyr --changes run.csv \
  --t-end 0.1 --out run.csv
