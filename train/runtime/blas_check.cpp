#include "train/runtime/blas_check.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <vector>

#include "base/problem.hpp"
#include "train/runtime/blas_kernels.hpp"

namespace swingbank::train::runtime {
namespace {

using Sgemm = void (*)(const char*, const char*, const int*, const int*, const int*, const float*,
                       const float*, const int*, const float*, const int*, const float*, float*, const int*);
Sgemm sgemm() {
  static const auto found = reinterpret_cast<Sgemm>(dlsym(RTLD_DEFAULT, "sgemm_"));
  return found;
}

/// Guard that limits OpenMP to one thread during its lifetime. Threads that were already started would be
/// missing in a process forked later.
class OneThread {
 public:
  OneThread() { omp_set_num_threads(1); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;
  ~OneThread() { omp_set_num_threads(before_); }

 private:
  int before_ = omp_get_max_threads();
};

/// Returns a matrix in BLAS's column order with pseudo-random numbers in -0.5 ... 0.5.
std::vector<float> numbers(int rows, int columns, unsigned seed) {
  std::vector<float> all(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns));
  for (auto& x : all) {
    seed = seed * 1664525u + 1013904223u;  // Numerical Recipes, "Quick and Dirty Generators"
    x = static_cast<float>(seed >> 8) / static_cast<float>(1u << 24) - 0.5f;
  }
  return all;
}

/// Returns the largest error of op(A) op(B), m x k times k x n, in units of its bound k eps sum |a b|.
double product_error(int m, int n, int k, bool a_turned, bool b_turned) {
  const int lda = a_turned ? k : m, ldb = b_turned ? n : k;
  const auto a = numbers(lda, a_turned ? m : k, 1), b = numbers(ldb, b_turned ? k : n, 2);
  std::vector<float> c(static_cast<std::size_t>(m) * static_cast<std::size_t>(n), 1e9f);
  const float one = 1.0f, zero = 0.0f;
  sgemm()(a_turned ? "T" : "N", b_turned ? "T" : "N", &m, &n, &k, &one, a.data(), &lda, b.data(), &ldb, &zero,
          c.data(), &m);
  double worst = 0.0;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < m; ++i) {
      double sum = 0.0, size = 0.0;
      for (int l = 0; l < k; ++l) {
        const double product =
            static_cast<double>(a[static_cast<std::size_t>(a_turned ? l + i * lda : i + l * lda)]) *
            static_cast<double>(b[static_cast<std::size_t>(b_turned ? j + l * ldb : l + j * ldb)]);
        sum += product;
        size += std::abs(product);
      }
      const double bound = k * static_cast<double>(std::numeric_limits<float>::epsilon()) * size;
      const double error = std::abs(static_cast<double>(c[static_cast<std::size_t>(i + j * m)]) - sum);
      worst = std::isfinite(error) ? std::max(worst, error / bound) : std::numeric_limits<double>::infinity();
    }
  return worst;
}

double thread_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}
template <class Work>
double seconds(const Work& work) {
  const double start = thread_seconds();
  work();
  return thread_seconds() - start;
}

constexpr int kSums = 12, kTimes = 200'000;
template <int Lanes>
struct Pack {
  typedef float Type
      __attribute__((vector_size(4 * Lanes)));  // GCC drops the attribute of a dependent `using`
};
/// Twelve sums hide the latency of a multiply-add. Together with factor and addend they fit into sixteen
/// registers.
template <int Lanes>
[[gnu::always_inline]] inline void add_up() {
  using P = typename Pack<Lanes>::Type;
  static_assert(sizeof(P) == 4 * Lanes);
  P sums[kSums];
  for (int i = 0; i < kSums; ++i) sums[i] = P{} + static_cast<float>(i);  // equal sums would be merged
  P factor = P{} + 0.999f, addend = P{} + 1e-3f;
  for (int t = 0; t < kTimes; ++t) {
#pragma GCC unroll 12
    for (int i = 0; i < kSums; ++i) sums[i] = sums[i] * factor + addend;
  }
  for (const P& s : sums) asm volatile("" ::"m"(s));
}
[[gnu::target("avx512f,fma")]] void add_up_avx512() { add_up<16>(); }
[[gnu::target("avx2,fma")]] void add_up_avx2() { add_up<8>(); }
void add_up_sse() { add_up<4>(); }

BlasRate measure() {
  const Processor here = Processor::here();
  const int lanes = here.avx512 ? 16 : here.avx2 ? 8 : 4, n = 512;
  const auto adds = here.avx512 ? add_up_avx512 : here.avx2 ? add_up_avx2 : add_up_sse;
  const auto a = numbers(n, n, 3), b = numbers(n, n, 4);
  std::vector<float> c(a.size());
  const float one = 1.0f, zero = 0.0f;
  BlasRate best;
  for (int go = 0; go < 6; ++go) {  // the measurements alternate, so that both have the same conditions
    best.multiply_adds = std::max(best.multiply_adds, 2e-9 * lanes * kSums * kTimes / seconds(adds));
    if (!sgemm()) continue;
    const double taken = seconds(
        [&] { sgemm()("N", "N", &n, &n, &n, &one, a.data(), &n, b.data(), &n, &zero, c.data(), &n); });
    best.product = std::max(best.product, 2e-9 * n * n * n / taken);
  }
  return best;
}

}  // namespace

std::string BlasRate::sentence() const {
  return fmt::format("{:.0f} GFLOP/s on one core, {:.0f} % of its {:.0f} GFLOP/s of multiply-adds", product,
                     100.0 * share(), multiply_adds);
}

std::string BlasRate::warning() const {
  // Kernels for the processor's widest instructions reach at least 60 % of the multiply-add rate. SSE kernels
  // reach 17 % on a processor with AVX-512 (docs/reference/performance.md).
  constexpr double kLeastOfPeak = 0.4;
  if (share() >= kLeastOfPeak) return "";
  return Problem{
      fmt::format("{:.0f} GFLOP/s", product), "BLAS",
      fmt::format("one core reaches {:.0f} GFLOP/s of multiply-adds, of which good kernels use at least 60 %",
                  multiply_adds),
      "install libopenblas0-openmp and unset OPENBLAS_CORETYPE; training is slow until then"}
      .sentence();
}

const BlasRate& blas_rate() {
  static const BlasRate rate = [] {
    const OneThread guard;
    return measure();
  }();
  return rate;
}

void require_right_products(const BlasFound& found) {
  if (!sgemm())
    throw InputError(
        {"no sgemm", "BLAS", "no library loaded by LibTorch provides it", "install libopenblas0-openmp"});
  const OneThread guard;
  double worst = 0.0;
  for (const bool a : {false, true})
    for (const bool b : {false, true}) worst = std::max(worst, product_error(67, 45, 123, a, b));
  if (worst <= 1.0) return;
  throw InputError({"a wrong matrix product", "BLAS",
                    fmt::format("{}: {:.3g} times the largest rounding error", blas_name(found), worst),
                    "set OPENBLAS_CORETYPE=HASWELL or install another BLAS"});
}

}  // namespace swingbank::train::runtime
