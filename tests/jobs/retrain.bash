# To be sourced by the tests of swingbank add --retrain, after lib.bash.
# shellcheck disable=SC2154 # work and swingbank are lib.bash's
export OMP_NUM_THREADS=1
model=$SWINGBANK_SOURCE/configs/plants/ieee14_bus2.toml
one=$work/avr_ev1.csv two=$work/avr_ev2.csv
# Six seconds, every other sample: the fit takes a fifth of the time.
for record in "$one" "$two"; do
  awk -F, '!/^[0-9]/ || (n++ % 2 == 0 && $1 <= 6)' "$SWINGBANK_SOURCE/configs/records/record-example/$(basename "$record")" >"$record"
done

# Few draws and one epoch: the procedure is tested, not the quality of the networks.
add() { "$swingbank" add SEXS --model "$model" --records "$one" "$two" --power-only --train-draws 60 --train-epochs 1 "$@"; }
retrain() { add --hold-out avr_ev2 --retrain "$@"; }
retrain_given() { retrain --dataset "$SWINGBANK_SOURCE/configs/datasets/ieee14_genrou_bus2.toml" --out "$work/given" >"$1" 2>"$work/log"; }
