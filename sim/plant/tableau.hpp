#pragma once
// Dormand-Prince 5(4) with its continuous extension of order 4. Source: J. R. Dormand, P. J. Prince, J. Comp.
// Appl. Math. 6 (1980) 19-26; dense output: E. Hairer, S. P. Norsett, G. Wanner, Solving Ordinary
// Differential Equations I (1993), II.6 and its code dopri5.
#include <bit>
#include <cstdint>

namespace swingbank::sim::plant::dp54 {

constexpr int kStages = 7;  ///< number of stages; the last stage is the first of the next step
/// Coefficients of the stages; the last row holds the fifth-order weights.
constexpr double a[7][6] = {{},
                            {1.0 / 5},
                            {3.0 / 40, 9.0 / 40},
                            {44.0 / 45, -56.0 / 15, 32.0 / 9},
                            {19372.0 / 6561, -25360.0 / 2187, 64448.0 / 6561, -212.0 / 729},
                            {9017.0 / 3168, -355.0 / 33, 46732.0 / 5247, 49.0 / 176, -5103.0 / 18656},
                            {35.0 / 384, 0.0, 500.0 / 1113, 125.0 / 192, -2187.0 / 6784, 11.0 / 84}};
/// Times of the stages, as a fraction of the step.
constexpr double c[7] = {0.0, 1.0 / 5, 3.0 / 10, 4.0 / 5, 8.0 / 9, 1.0, 1.0};
/// Fifth-order minus fourth-order weights.
constexpr double error[7] = {71.0 / 57600,      0.0,        -71.0 / 16695, 71.0 / 1920,
                             -17253.0 / 339200, 22.0 / 525, -1.0 / 40};
/// Coefficients of the continuous extension.
constexpr double dense[7] = {-12715105075.0 / 11282082432.0,  0.0,
                             87487479700.0 / 32700410799.0,   -10690763975.0 / 1880347072.0,
                             701980252875.0 / 199316789632.0, -1453857185.0 / 822651844.0,
                             69997945.0 / 29380423.0};

/// Time of the fifth stage, as a fraction of the step.
constexpr double c5 = 8.0 / 9;
/// Weights of two third divided differences of the stages' derivatives, at c = 0, 0.3, 0.8, 1 and at 0.3,
/// 0.8, 8/9, 1. They detect a kink inside a step of length h, which `error` nearly misses. Let y'' jump by J
/// at the fraction theta of the step. For 0.3 < theta < 0.8, `error` is then at most 0.0011 J h^2 (zero at
/// theta = 0.42), but the true error is up to 0.02 J h^2. For 0.2 < theta < 0.9, one of the two differences,
/// times h, is at least 0.6 J h^2.
constexpr double kink[2][7] = {
    {-1.0 / (0.3 * 0.8), 0.0, 1.0 / (0.3 * 0.5 * 0.7), -1.0 / (0.8 * 0.5 * 0.2), 0.0, 0.0, 1.0 / (0.7 * 0.2)},
    {0.0, 0.0, -1.0 / (0.5 * (c5 - 0.3) * 0.7), 1.0 / (0.5 * (c5 - 0.8) * 0.2),
     -1.0 / ((c5 - 0.3) * (c5 - 0.8) * (1.0 - c5)), 0.0, 1.0 / (0.7 * 0.2 * (1.0 - c5))}};

/// Returns x^p with a relative error below 6 %, bitwise equal on every machine. Only for the step controller.
inline float rough_power(float x, float p) {
  const float log2 = static_cast<float>(std::bit_cast<std::int32_t>(x)) * 1.1920929e-7F - 126.94269504F;
  return std::bit_cast<float>(static_cast<std::int32_t>((log2 * p + 126.94269504F) * 8388608.0F));
}

}  // namespace swingbank::sim::plant::dp54
