#!/usr/bin/env bash
# packaging/: the Apptainer definition and the Spack package, as far as possible without Apptainer and Spack; ranks of
# another MPI's launcher are refused.
# shellcheck disable=SC2154 # set by lib.bash
source "$(dirname "${BASH_SOURCE[0]}")/lib.bash"
folder=$SWINGBANK_SOURCE/packaging

source "$(dirname "${BASH_SOURCE[0]}")/apptainer.bash"
for section in post environment test runscript; do
  { echo '#!/bin/sh'; section_of "$section"; } >"$work/$section.sh"
  (($(wc -l <"$work/$section.sh") > 1)) || fail "no %$section"
  sh -n "$work/$section.sh" || fail "%$section is no script"
  if command -v shellcheck >/dev/null; then shellcheck -s sh -S warning "$work/$section.sh" || fail "%$section"; fi
done
grep -q '^From: debian:12$' "$folder/swingbank.def" || fail "not Debian 12"
# %files names the Debian packages of the programs, in the build folder of a preset
section_of files >"$work/files"
read -r file target <"$work/files"
[[ $(wc -l <"$work/files") == 1 && $file =~ ^build/([a-z]+)/swingbank\*_\*\.deb$ && $target == /packages/ ]] ||
  fail "%files: $(cat "$work/files")"
grep -q "\"name\": \"${BASH_REMATCH[1]}\"" "$SWINGBANK_SOURCE/CMakePresets.json" || fail "no preset ${BASH_REMATCH[1]}"
[[ $("$swingbank" effects) == *GENROU* ]] || fail "%test would fail"
echo "ok: Apptainer definition"

/usr/bin/python3 - "$SWINGBANK_SOURCE" <<'PYTHON' || fail "Spack package"
import re, sys, types
root = sys.argv[1]
said = {"depends_on": [], "variant": [], "version": []}
class Spec:
    variants = {"arch": types.SimpleNamespace(value="native")}
class CMakePackage:
    spec = Spec()
    def define(self, name, value): return (name, value)
    def define_from_variant(self, name, variant): return (name, variant)
stub = types.ModuleType("spack.package")
stub.CMakePackage = CMakePackage
stub.join_path = lambda *parts: "/".join(parts)
for name in ("license", "requires", "generator"): setattr(stub, name, lambda *a, **k: None)
for name in said: setattr(stub, name, lambda *a, _n=name, **k: said[_n].append(a[0]))
stub.__all__ = [n for n in vars(stub) if not n.startswith("__")]
sys.modules["spack"] = types.ModuleType("spack")
sys.modules["spack.package"] = stub
space = {}
exec(compile(open(f"{root}/packaging/spack/swingbank/package.py").read(), "package.py", "exec"), space)
names = {re.split(r"[@ +~]", d)[0] for d in said["depends_on"]}
text = "".join(open(f"{root}/{f}").read() for f in ("cmake/dependencies.cmake", "mpi/CMakeLists.txt", "train/CMakeLists.txt"))
asked = set(re.findall(r"find_package\((\w+)", text)) | set(re.findall(r"IMPORTED_TARGET (\S+?)\)", text))
spack = {"Eigen3": "eigen", "SUNDIALS": "sundials", "spdlog": "spdlog", "fmt": "fmt", "tomlplusplus": "tomlplusplus",
         "CLI11": "cli11", "nlohmann_json": "nlohmann-json", "Boost": "boost", "Ceres": "ceres-solver", "PkgConfig": "pkgconfig", "matio": "matio",
         "libxxhash": "xxhash", "libcrypto": "openssl", "MPI": "mpi", "HDF5": "hdf5", "Torch": "py-torch", "OpenMP": "cxx"}
unknown = {a for a in asked if a not in spack}
assert not unknown, f"CMake asks for {unknown}: say by which Spack package it is met"
missing = {a for a in asked if spack[a] not in names}
assert not missing, f"package.py lacks what CMake asks for: {missing}"
assert len(asked) > 12, asked
cmake = "".join(open(f"{root}/{f}").read() for f in ("CMakeLists.txt", "validate/CMakeLists.txt"))
options = [name for name, _ in space["Swingbank"]().cmake_args()]
for option in options:
    assert option in cmake, f"CMake has no {option}"
assert {"arch", "train"} == set(said["variant"]) and said["version"], said
PYTHON
echo "ok: Spack package"

for variable in PMI_SIZE OMPI_COMM_WORLD_SIZE; do
  refuses "ranks of another launcher ($variable)" "unconnected ranks at the launcher .*$variable it started 4" \
    env $variable=4 OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 "$SWINGBANK_BIN/swingbank-generate" \
    "$SWINGBANK_SOURCE/configs/datasets/ieee39_gencls.toml" --draws 10 --out "$work/data"
  [[ ! -e $work/data ]] || fail "a refused command wrote data"
done
