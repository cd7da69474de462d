#include "sim/reference/detail/vector.hpp"

#include <nvector/nvector_serial.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

namespace swingbank::sim::reference {
namespace {

double* data(N_Vector v) { return N_VGetArrayPointer(v); }
sunindextype length(N_Vector v) { return N_VGetLength(v); }

/// Computes z = a x + b y; z may be x or y.
void linear_sum(realtype a, N_Vector x, realtype b, N_Vector y, N_Vector z) {
  const double *px = data(x), *py = data(y);
  double* pz = data(z);
  const sunindextype n = length(z);
#pragma GCC ivdep
  for (sunindextype i = 0; i < n; ++i) pz[i] = a * px[i] + b * py[i];
}

void scale(realtype a, N_Vector x, N_Vector z) {
  const double* px = data(x);
  double* pz = data(z);
  const sunindextype n = length(z);
#pragma GCC ivdep
  for (sunindextype i = 0; i < n; ++i) pz[i] = a * px[i];
}

void fill(realtype a, N_Vector z) { std::fill_n(data(z), length(z), a); }

/// Adds four terms at a time, so that the sum is written to memory only once for the four terms.
int linear_combination(int terms, realtype* factors, N_Vector* vectors, N_Vector z) {
  double* pz = data(z);
  const sunindextype n = length(z);
  constexpr int kTerms = 4;
  // z may be the first vector, but no other.
  if (terms == 1) {
    scale(factors[0], vectors[0], z);
    return 0;
  }
  for (int first = 0; first < terms; first += kTerms) {
    double f[kTerms] = {};
    const double* p[kTerms];
    for (int k = 0; k < kTerms; ++k) {
      const bool has = first + k < terms;
      f[k] = has ? factors[first + k] : 0.0;
      p[k] = data(vectors[has ? first + k : first]);
    }
    const double *p0 = p[0], *p1 = p[1], *p2 = p[2], *p3 = p[3];
    const double f0 = f[0], f1 = f[1], f2 = f[2], f3 = f[3];
    if (first == 0) {
#pragma GCC ivdep
      for (sunindextype i = 0; i < n; ++i) pz[i] = f0 * p0[i] + f1 * p1[i] + f2 * p2[i] + f3 * p3[i];
    } else {
#pragma GCC ivdep
      for (sunindextype i = 0; i < n; ++i) pz[i] += f0 * p0[i] + f1 * p1[i] + f2 * p2[i] + f3 * p3[i];
    }
  }
  return 0;
}

/// Computes z_k = a_k x + y_k.
int scale_add_multi(int count, realtype* a, N_Vector x, N_Vector* y, N_Vector* z) {
  for (int k = 0; k < count; ++k) linear_sum(a[k], x, 1.0, y[k], z[k]);
  return 0;
}

int linear_sum_array(int count, realtype a, N_Vector* x, realtype b, N_Vector* y, N_Vector* z) {
  for (int k = 0; k < count; ++k) linear_sum(a, x[k], b, y[k], z[k]);
  return 0;
}

int scale_array(int count, realtype* a, N_Vector* x, N_Vector* z) {
  for (int k = 0; k < count; ++k)
    if (a[k] != 1.0 || x[k] != z[k]) scale(a[k], x[k], z[k]);
  return 0;
}

/// Returns the largest |x_i| w_i; NaN if an element is NaN.
realtype largest(N_Vector x, N_Vector w) {
  const double *px = data(x), *pw = data(w);
  const sunindextype n = length(x);
  constexpr int kParts = 16;
  double worst[kParts] = {}, sum[kParts] = {};
  sunindextype i = 0;
  for (; i + kParts <= n; i += kParts)
    for (int k = 0; k < kParts; ++k) {
      const double e = std::abs(px[i + k]) * pw[i + k];
      worst[k] = e > worst[k] ? e : worst[k];
      sum[k] += e;
    }
  for (; i < n; ++i) {
    const double e = std::abs(px[i]) * pw[i];
    worst[0] = e > worst[0] ? e : worst[0];
    sum[0] += e;
  }
  double all = 0.0, total = 0.0;
  for (int k = 0; k < kParts; ++k) {
    all = std::max(all, worst[k]);
    total += sum[k];
  }
  return std::isnan(total) ? std::numeric_limits<double>::quiet_NaN() : all;
}

}  // namespace

N_Vector new_vector(sunindextype length, SUNContext context) {
  const N_Vector v = N_VNew_Serial(length, context);
  if (v == nullptr) throw std::bad_alloc();
  N_Vector_Ops ops = v->ops;  // inherited by clones
  ops->nvlinearsum = linear_sum;
  ops->nvscale = scale;
  ops->nvconst = fill;
  ops->nvwrmsnorm = largest;
  ops->nvlinearcombination = linear_combination;
  ops->nvscaleaddmulti = scale_add_multi;
  ops->nvlinearsumvectorarray = linear_sum_array;
  ops->nvscalevectorarray = scale_array;
  return v;
}

}  // namespace swingbank::sim::reference
