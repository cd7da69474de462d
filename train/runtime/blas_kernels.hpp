#pragma once
// Selection of the BLAS library's kernels. OpenBLAS selects its kernels by a list of processor models. A
// processor newer than the list in Debian 12's version gets kernels of 2004, at a quarter of the possible
// speed.
#include <string>

namespace swingbank::train::runtime {

/// Instruction sets that processor and operating system support, as far as kernels depend on them.
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
  std::string alone;  ///< the library's own choice before a request by this program; empty: no request
  static BlasFound here();
};

struct BlasChoice {
  std::string restart_with;  ///< OPENBLAS_CORETYPE for a restart; empty: no restart
  std::string warning;       ///< a sentence; empty: none
};
/// Chooses the widest kernels that the processor can run. If the user requested other kernels, keeps these
/// with a warning. Throws InputError if the requested kernels need instructions that the processor lacks.
BlasChoice choose_blas_kernels(const Processor& processor, const BlasFound& found);

/// Returns library, version and kernels as text. If the library did not choose the kernels itself, the text
/// contains the reason.
std::string blas_name(const BlasFound& found);

/// Returns the instruction set of LibTorch's own loops ("AVX2"). LibTorch selects it by processor features,
/// not by model.
std::string tensor_instructions();

/// Selects the best kernels. Call it before any thread starts. OpenBLAS chooses kernels while the program is
/// loaded. If faster ones are available, the program restarts itself with their name in the environment. Then
/// it checks and measures the library (blas_check.hpp), and prints one line and any warnings to standard
/// error. Throws InputError if the library's products are wrong or its kernels cannot run on this processor.
void use_best_blas_kernels(char** argv);

}  // namespace swingbank::train::runtime
