#!/usr/bin/env bash
# Follows docs/how-to/add-an-effect.md literally in a copy of the tree: writes its files and runs its commands. The
# listing, the simulator, the generator and compare must find both the user-defined model and the header without another
# edit.
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
own_mounts

build=${SWINGBANK_BIN%/bin}
tree=$work/tree
# For this script only, the copy is mounted over the tree and the build folder. The absolute paths in the build files
# then remain valid, and only the targets of the new header are rebuilt. Targets that link LibTorch are excluded.
copy_tree() {
  mkdir "$tree"
  (cd "$SWINGBANK_SOURCE" && tar -cf - --exclude=./build --exclude=./.git --exclude=./out .) | tar -xf - -C "$tree"
  if [[ $build == "$SWINGBANK_SOURCE"/* ]]; then
    copy=$tree/${build#"$SWINGBANK_SOURCE"/}
  else
    copy=$work/build
  fi
  mkdir -p "$copy"
  (cd "$build" && tar -cf - --exclude=./train --exclude=./Testing --exclude='./bin/*' .) | tar -xf - -C "$copy"
  touch "$tree/a-copy" "$copy/a-copy"
  mount --bind "$tree" "$SWINGBANK_SOURCE"
  [[ $copy == "$tree"/* ]] || mount --bind "$copy" "$build"
  [[ -e $SWINGBANK_SOURCE/a-copy && -e $build/a-copy ]] || fail "the copy is not in its place"
}
copy_tree
cd "$SWINGBANK_SOURCE"

# The document's blocks: ```LANGUAGE file=NAME is a file, ```bash a command.
/usr/bin/python3 - docs/how-to/add-an-effect.md "$work" <<'PYTHON'
import pathlib, re, sys

text, work = pathlib.Path(sys.argv[1]).read_text(), pathlib.Path(sys.argv[2])
files = re.findall(r"^```\w+ file=(\S+)\n(.*?)^```$", text, re.M | re.S)
commands = re.findall(r"^```bash\n(.*?)^```$", text, re.M | re.S)
fences = len(re.findall(r"^```", text, re.M))
assert fences == 2 * (len(files) + len(commands)), "a block is neither a file nor a command"
for name, content in files:
    path = pathlib.Path(name)
    assert not path.exists(), f"{name} is in the tree already"
    path.write_text(content)
for i, command in enumerate(commands):
    (work / f"command{i}.sh").write_text(command)
print("\n".join(name for name, _ in files))
PYTHON
commands=("$work"/command*.sh)
((${#commands[@]} == 3)) || fail "${#commands[@]} command blocks in the document, 3 expected"

# All targets existed before, so that no file of the tree needs an edit.
built=(swingbank swingbank-effects swingbank-simulate swingbank-generate swingbank-compare test_sim_effects)
cmake --build "$build" --target "${built[@]}" >"$work/build.log" 2>&1 || fail "the build: $(tail -n 40 "$work/build.log")"
echo "ok: built after $SECONDS s"
"$build/bin/test_sim_effects" --gtest_filter='*onformance.*:Fluxlim.*-*Full.*' >"$work/test.log" 2>&1 || fail "conformance: $(grep -A5 -E 'Failure|FAILED' "$work/test.log" | head -40)"
grep -q '\[       OK \] Fluxlim.FollowsTheExcessWithItsLag' "$work/test.log" || fail "the header's own test did not run"
for suite in Conformance PlantConformance; do
  grep -q "tests\? from $suite " "$work/test.log" || fail "$suite did not run"
done

PATH=$build/bin:$PATH
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMP_NUM_THREADS=1
for command in "${commands[@]}"; do
  status=0
  bash -euo pipefail "$command" >"$command.log" 2>&1 </dev/null || status=$?
  # compare exits with 3 or 4 if a plant does not explain its record, as the document states
  ((status == 0)) || { ((status == 3 || status == 4)) && grep -q 'swingbank compare' "$command"; } ||
    fail "exit code $status of: $(cat "$command"): $(tail "$command.log")"
done
grep -q 'slot: limiter' "$work/command2.sh.log" || fail "the listing of FLUXLIM: $(cat "$work/command2.sh.log")"
swingbank effects | holds -q '^  FLUXLIM ' || fail "FLUXLIM is not in the list"

/usr/bin/python3 - <<'PYTHON'
import csv, glob, json, pathlib
import h5py, numpy

def table(name):
    with open(name) as file:
        rows = list(csv.reader(file))
    return dict(zip(rows[0], numpy.array(rows[1:], float).T))

model, header = table("model.csv"), table("header.csv")
efd = model["2.Efd_pu"]
assert abs(efd[-1] - efd[0]) > 0.1  # the step and the limiter move it
for name in model:  # two runs of the same equations by the reference integrator at rtol 1e-8
    worst = numpy.abs(model[name] - header[name]).max()
    assert worst < 1e-5, (name, worst)

def records(folder):
    arrays = []
    for shard in sorted(glob.glob(f"{folder}/shards/*.h5")):
        with h5py.File(shard) as file:
            arrays.append(file["records"][:])
    return numpy.concatenate(arrays)

a, b = records("model_data"), records("header_data")
assert a.shape == b.shape and a.shape[0] == 4, (a.shape, b.shape)
assert numpy.abs(a - b).max() < 1e-5, numpy.abs(a - b).max()  # float32 of values near 1 to 5

for name, folder in (("FLUXMODEL", "model_compared"), ("FLUXLIM", "header_compared")):
    assert (pathlib.Path(folder) / "compare.json").stat().st_size > 0
    assert pathlib.Path(folder, "report.html").exists()
one, other = (json.loads(pathlib.Path(f, "compare.json").read_text()) for f in ("model_compared", "header_compared"))

def numbers(node):
    if isinstance(node, dict):
        return [v for child in node.values() for v in numbers(child)]
    if isinstance(node, list):
        return [v for child in node for v in numbers(child)]
    return [node] if isinstance(node, float) else []

p, q = numbers(one), numbers(other)
assert len(p) == len(q) > 10
assert max(abs(x - y) / (1 + abs(x)) for x, y in zip(p, q)) < 1e-4  # tolerance of the play-in
PYTHON
echo "ok: user-defined model and header of docs/how-to/add-an-effect.md, after $SECONDS s"
