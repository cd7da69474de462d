#pragma once
// Which kernels the BLAS library takes, and which it should. OpenBLAS goes by a list of processor models: one
// newer than the list gets kernels of 2004, in the version of Debian 12 a quarter of the speed.
#include <string>

namespace swingbank::train::runtime {

/// The instructions by which kernels differ, as processor and operating system offer them.
struct Processor {
  bool avx = false;
  bool avx2 = false;    ///< with FMA
  bool avx512 = false;  ///< F, CD, BW, DQ and VL: what kernels of Skylake-X need
  bool fma4 = false;    ///< four-operand multiply-adds of AMD's Bulldozer family
  static Processor here();
};

struct BlasFound {
  std::string core;   ///< kernels that the library reports ("Haswell"); empty: it is not OpenBLAS
  std::string asked;  ///< OPENBLAS_CORETYPE; empty: not set
  std::string
      alone;  ///< what the library took by itself before this program asked for others; empty: it did not
  static BlasFound here();
};

struct BlasChoice {
  std::string restart_with;  ///< OPENBLAS_CORETYPE to start again with; empty: go on
  std::string warning;       ///< a sentence; empty: nothing is wrong
};
/// The widest kernels that the processor can run, unless the user asked for others: then a warning. Throws
/// InputError where those asked for need instructions that the processor does not have.
BlasChoice choose_blas_kernels(const Processor& processor, const BlasFound& found);

/// Library, version and kernels in words; why these, where the library did not choose by itself.
std::string blas_name(const BlasFound& found);

/// "AVX2": instructions of LibTorch's own loops, which it chooses by features and not by model.
std::string tensor_instructions();

/// To be called before any thread starts. OpenBLAS chooses while the program is loaded; where it chose badly,
/// this program runs itself again with the right choice in its environment. Then the library is checked and
/// measured (blas_check.hpp), and one line on stderr says what is used; warnings follow. Throws InputError if
/// the library multiplies wrongly or cannot run here.
void use_best_blas_kernels(char** argv);

}  // namespace swingbank::train::runtime
