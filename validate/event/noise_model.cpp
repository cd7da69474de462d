#include "validate/event/noise_model.hpp"

namespace swingbank::validate::event {

void EventNoise::whiten(RowMatrix& e) const {
  if (memory) return memory->whiten(e);
  const Eigen::Index n = whitening.rows();
  for (Eigen::Index row = 0; row < e.rows(); row += n)
    e.middleRows(row, n) = (whitening.triangularView<Eigen::Lower>() * e.middleRows(row, n)).eval();
}

}  // namespace swingbank::validate::event
