# Spack package of Swingbank, kept in this folder until it is part of Spack's repository:
#   spack repo add packaging/spack && spack install swingbank
from spack.package import *


class Swingbank(CMakePackage):
    """Model validation of power plants at scale: simulates faults on a grid by the million, trains networks on them, and
    compares, calibrates and diagnoses plant models with records of real disturbances."""

    license("BSD-3-Clause")

    version("main", branch="main")

    variant("train", default=True, description="networks, with LibTorch")
    variant(
        "arch",
        default="native",
        values=("native", "x86-64-v2", "x86-64-v3", "x86-64-v4"),
        description="instruction set that the simulator is built for",
    )

    depends_on("c", type="build")
    depends_on("cxx", type="build")
    depends_on("cmake@3.25:", type="build")
    depends_on("ninja", type="build")
    depends_on("pkgconfig", type="build")
    depends_on("help2man", type="build")
    depends_on("mpi")
    depends_on("hdf5@1.10:1.14 +mpi")
    depends_on("eigen@3.4:3")
    depends_on("boost@1.74: +math")
    depends_on("ceres-solver@2.1:")
    depends_on("sundials@6.4:6 +klu +ida")
    depends_on("suite-sparse")
    depends_on("spdlog +fmt_external")
    depends_on("fmt")
    depends_on("tomlplusplus")
    depends_on("cli11")
    depends_on("nlohmann-json")
    depends_on("xxhash")
    depends_on("openssl")
    depends_on("random123")
    depends_on("matio")
    depends_on("blas")
    depends_on("py-torch", when="+train")

    requires("%gcc@12:", msg="C++20 as GCC 12 knows it")

    generator("ninja")

    def cmake_args(self):
        return [
            self.define("SWINGBANK_ARCH", self.spec.variants["arch"].value),
            self.define_from_variant("SWINGBANK_TRAIN", "train"),
            self.define("SWINGBANK_TESTS", False),
            self.define("SWINGBANK_BENCH", False),
        ]
