#include "validate/noise/noise_model.hpp"

#include <stdexcept>

namespace swingbank::validate::noise {

void EventNoise::whiten(RowMatrix& e) const {
  if (memory) return memory->whiten(e);
  const Eigen::Index n = whitening.rows();
  for (Eigen::Index row = 0; row < e.rows(); row += n)
    e.middleRows(row, n) = (whitening.triangularView<Eigen::Lower>() * e.middleRows(row, n)).eval();
}

void require_same(const NoiseModel& a, const NoiseModel& b) {
  if (a != b)
    throw std::logic_error(
        "the costs of two fits with different noise models cannot be compared: fit both again "
        "with the latest noise model");
}

}  // namespace swingbank::validate::noise
