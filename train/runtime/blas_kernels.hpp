#pragma once
// Selection of the BLAS library's kernels. OpenBLAS selects by a list of processor models. A processor newer
// than the list gets kernels of 2004, which in Debian 12's version have a quarter of the speed.
#include <string>

namespace swingbank::train::runtime {

/// Instruction sets that kernels depend on, as processor and operating system provide them.
struct Processor {
  bool avx = false;
  bool avx2 = false;    ///< with FMA
  bool avx512 = false;  ///< F, CD, BW, DQ and VL: required by Skylake-X kernels
  bool fma4 = false;    ///< four-operand multiply-adds of AMD's Bulldozer family
  static Processor here();
};

struct BlasFound {
  std::string core;   ///< kernels reported by the library ("Haswell"); empty: not OpenBLAS
  std::string asked;  ///< OPENBLAS_CORETYPE; empty: not set
  std::string alone;  ///< the library's own choice before this program requested others; empty: no request
  static BlasFound here();
};

struct BlasChoice {
  std::string restart_with;  ///< OPENBLAS_CORETYPE for a restart; empty: no restart
  std::string warning;       ///< a sentence; empty: none
};
/// Chooses the widest kernels that the processor can run. If the user requested others, keeps them with a
/// warning. Throws InputError if the requested kernels need instructions that the processor lacks.
BlasChoice choose_blas_kernels(const Processor& processor, const BlasFound& found);

/// Returns library, version and kernels as text, with the reason if the library did not choose them itself.
std::string blas_name(const BlasFound& found);

/// Returns the instructions of LibTorch's own loops ("AVX2"), which it selects by features and not by model.
std::string tensor_instructions();

/// Selects the best kernels; call before any thread starts. OpenBLAS chooses while the program is loaded. If
/// that choice is poor, the program restarts itself with the right choice in its environment. Then it checks
/// and measures the library (blas_check.hpp) and prints one line and any warnings to standard error. Throws
/// InputError if the library multiplies wrongly or cannot run here.
void use_best_blas_kernels(char** argv);

}  // namespace swingbank::train::runtime
