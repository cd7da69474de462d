#pragma once
// Integration of one segment by SUNDIALS IDA with KLU, from consistent values at its start exactly to its
// end.
#include <memory>

#include "sim/reference/detail/nonzeros.hpp"
#include "sim/reference/detail/vector.hpp"
#include "sim/reference/reference.hpp"

namespace swingbank::sim::reference {

/// Throws std::runtime_error if a SUNDIALS call failed.
void require(int flag, const char* call);

class SegmentSolver {
 public:
  /// y, yp: consistent values at `start` [s]; `seen`: entries of the Jacobian that were nonzero in the run.
  SegmentSolver(SUNContext context, const ReferenceSystem& system, N_Vector y, N_Vector yp, double start,
                double end, const ReferenceOptions& options, SeenEntries& seen);
  ~SegmentSolver();
  SegmentSolver(const SegmentSolver&) = delete;
  SegmentSolver& operator=(const SegmentSolver&) = delete;
  /// Advances y and y' to time t [s]. Returns false if IDA fails; y and y' are then the values at reached().
  bool advance(double t);
  [[nodiscard]] double reached() const { return reached_; }  ///< time reached [s]
  [[nodiscard]] long steps() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
  double reached_;
};

}  // namespace swingbank::sim::reference
