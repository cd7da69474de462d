#!/usr/bin/env bash
# Ranks that train one network together: except for rounding, the training equals that of one rank. For a given number
# of ranks it is reproducible, and a run resumed after kill -9 of any rank ends with the same network.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
source "$(dirname "${BASH_SOURCE[0]}")/tiny_experiment.bash"
source "$(dirname "${BASH_SOURCE[0]}")/same_training.bash"
export OMP_NUM_THREADS=1 OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1

TINY_DRAWS=200 TINY_EPOCHS=20 tiny_experiment "$work"
sed -i 's/^split = .*/split = "by-databank-point"/; /^folds/d; s/"gru"/"cnn", "mlp"/' "$work/tiny.toml"
"$swingbank" generate "$work/tiny_data.toml" --progress none --out "$work/data" >"$work/log" 2>&1 || fail "$(cat "$work/log")"

# train RANKS NETWORK OUT OPTION...: trains on RANKS ranks
train() {
  local start=()
  (($1 == 1)) || start=(mpirun --oversubscribe -np "$1")
  "${start[@]}" "$swingbank" train "$work/data" --experiment "$work/tiny.toml" --network "$2" --out "$work/$3" "${@:4}" \
    >"$work/log" 2>&1
}

for n in 1 2 3 7; do train "$n" mlp "mlp-$n" --epochs 3 || fail "$n ranks: $(cat "$work/log")"; done
for n in 1 3; do train "$n" cnn "cnn-$n" --epochs 3 || fail "$n ranks: $(cat "$work/log")"; done
# Rounding errors grow with the steps. A wrong share of the rows or another dropout mask would change the first epoch.
/usr/bin/python3 - "$work" <<'PYTHON'
import json, sys
def read(network, ranks):
    result = json.load(open(f"{sys.argv[1]}/{network}-{ranks}/V-{network}-quick-seed1.json"))
    assert result["ranks"] == ranks, (network, ranks, result["ranks"])
    return [e[key] for e in result["curve"] for key in ("training_loss", "validation_loss")]
for network, others, tolerance in (("mlp", (2, 3, 7), 1e-5), ("cnn", (3,), 1e-3)):
    alone = read(network, 1)
    for ranks in others:
        worst = max(abs(a / b - 1) for a, b in list(zip(read(network, ranks), alone))[: 6 if network == "mlp" else 2])
        print(f"{network}, {ranks} ranks: largest relative difference of a loss {worst:.1e}")
        assert worst < tolerance, (network, ranks, worst)
PYTHON

# Checkpoints are written every two seconds, so the runs take several.
long=(--epochs 80)
train 2 mlp whole "${long[@]}" || fail "whole run: $(cat "$work/log")"
for killed in 0 1; do
  out=killed-$killed
  train 2 mlp "$out" "${long[@]}" &
  for _ in {1..600}; do
    [[ ! -s $work/$out/checkpoints/V-mlp-quick-seed1.checkpoint ]] || break
    sleep 0.05
  done
  for pid in $(pgrep -f "swingbank-train-ranks.*--out $work/$out"); do
    if grep -qz "^OMPI_COMM_WORLD_RANK=$killed\$" "/proc/$pid/environ" 2>/dev/null; then kill -9 "$pid"; fi
  done
  ! wait %+ || fail "rank $killed was not killed: $(cat "$work/log")"
  [[ ! -e $work/$out/V-mlp-quick-seed1.json ]] || fail "a killed run has a result"
  train 2 mlp "$out" "${long[@]}" || fail "resumed after rank $killed was killed: $(cat "$work/log")"
  grep -q 'resumed at epoch' "$work/log" || fail "not resumed: $(cat "$work/log")"
  diff <(essence "$work/whole") <(essence "$work/$out") || fail "another result after rank $killed was killed"
done

sed -i 's/^batch = .*/batch = 2/' "$work/tiny.toml"
! train 3 mlp many || fail "3 ranks share a batch of 2 rows"
grep -q '^3 ranks at mpirun (a batch has 2 rows' "$work/log" || fail "3 ranks: $(cat "$work/log")"
[[ ! -e $work/many ]] || fail "a refused run left $(find "$work/many")"
