#include "sim/reference/detail/segment_solver.hpp"

#include <ida/ida.h>
#include <sunlinsol/sunlinsol_klu.h>
#include <sunmatrix/sunmatrix_sparse.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "base/stop_signal.hpp"

namespace swingbank::sim::reference {

void require(int flag, const char* call) {
  if (flag < 0)
    throw std::runtime_error(std::string(call) + " failed with SUNDIALS code " + std::to_string(flag));
}

/// Callbacks of IDA and their data. The namespace has a name because SegmentSolver::Parts has members of its
/// types, and all files of a module may be compiled as one unit.
namespace segments {

constexpr int kMinimumDegree = 0;  ///< minimum-degree ordering; less fill-in here than with COLAMD
/// Relative change of the leading coefficient a (system.hpp) that triggers a new factorisation. IDA's 0.25 is
/// for expensive matrices. Here a factorisation costs only as much as two residual evaluations, and with new
/// factors Newton's method ends with smaller residuals.
constexpr double kFactorAnew = 0.1;
/// Number of steps after which the units' derivatives are recomputed (CVODE: 50). They are recomputed
/// earlier after a failed step, which may have crossed a limit, or if Newton's method does not converge.
constexpr long kStepsPerJacobian = 20;

/// User data of the callbacks below.
struct Problem {
  const ReferenceSystem& system;
  const ReferenceOptions& options;
  std::vector<double> weight;  ///< error weight of each unknown
  Nonzeros nonzeros;
  std::vector<double> values;  ///< values of the Jacobian, in the full pattern
  std::vector<int> own;        ///< positions of the states' diagonal entries in the full pattern
  SUNLinearSolver solver = nullptr;
  void* ida = nullptr;
  double a = 0.0;                                 ///< leading coefficient with which `values` was computed
  long steps = -kStepsPerJacobian, failures = 0;  ///< IDA's counts when the derivatives were last computed

  /// Whether the units' derivatives must be recomputed when IDA requests a matrix with leading coefficient
  /// `now`. IDA requests a matrix with an unchanged coefficient if Newton's method has not converged.
  bool old(double now) {
    constexpr double kSame = (1.0 - kFactorAnew) / (1.0 + kFactorAnew);
    long count = 0, failed = 0, rejected = 0;
    IDAGetNumSteps(ida, &count);
    IDAGetNumNonlinSolvConvFails(ida, &failed);
    IDAGetNumErrTestFails(ida, &rejected);
    failed += rejected;
    const bool stalls = now > kSame * a && now * kSame < a;
    if (count - steps < kStepsPerJacobian && failed == failures && !stalls) return false;
    steps = count;
    failures = failed;
    return true;
  }
};

int residual(realtype t, N_Vector y, N_Vector yp, N_Vector f, void* user) {
  const auto& system = static_cast<const Problem*>(user)->system;
  system.residual(t, N_VGetArrayPointer(y), N_VGetArrayPointer(yp), N_VGetArrayPointer(f));
  const double* value = N_VGetArrayPointer(f);
  // The return value 1 asks IDA for a smaller step, because a value is not finite.
  return std::all_of(value, value + system.size(), [](double v) { return std::isfinite(v); }) ? 0 : 1;
}

int jacobian(realtype t, realtype a, N_Vector y, N_Vector, N_Vector, SUNMatrix j, void* user, N_Vector,
             N_Vector, N_Vector) {
  auto& p = *static_cast<Problem*>(user);
  const bool anew = p.old(a);
  if (anew)
    p.system.jacobian(t, a, N_VGetArrayPointer(y), p.values.data());
  else
    for (const int place : p.own) p.values[static_cast<std::size_t>(place)] += a - p.a;
  p.a = a;
  if (anew && p.nonzeros.take(p.values)) {  // the fill-reducing ordering is recomputed
    if (SUNLinSol_KLUReInit(p.solver, j, p.nonzeros.count(), SUNKLU_REINIT_FULL) < 0) return -1;
    p.nonzeros.pattern(SUNSparseMatrix_IndexPointers(j), SUNSparseMatrix_IndexValues(j));
  }
  p.nonzeros.gather(p.values, SUNSparseMatrix_Data(j));
  return 0;
}

/// Replaces the operation by which IDA clears a matrix with its pattern. This matrix keeps its pattern, and
/// all its values are overwritten.
int keep(SUNMatrix) { return 0; }

/// Error weights for the norm of the largest weighted error (detail/vector.hpp). The tolerance applies to
/// each unknown; unknowns that act through a gain have larger weights.
int error_weights(N_Vector y, N_Vector weights, void* user) {
  const auto& p = *static_cast<const Problem*>(user);
  const double* value = N_VGetArrayPointer(y);
  double* to = N_VGetArrayPointer(weights);
  for (std::size_t i = 0; i < p.weight.size(); ++i)
    to[i] = p.weight[i] / (p.options.rtol * std::abs(value[i]) + p.options.atol);
  return 0;
}

void quiet(int, const char*, const char*, char*, void*) {}  // no output: failures are return values

struct FreeMatrix {
  void operator()(SUNMatrix m) const { SUNMatDestroy(m); }
};
struct FreeSolver {
  void operator()(SUNLinearSolver s) const { SUNLinSolFree(s); }
};
struct FreeIda {
  void operator()(void* m) const { IDAFree(&m); }
};
template <class Handle, class Free>
using Owner = std::unique_ptr<std::remove_pointer_t<Handle>, Free>;

std::vector<int> own_places(const ReferenceSystem& system) {
  std::vector<int> own;
  for (std::size_t u = 0; u < system.units().size(); ++u) {
    const auto n = static_cast<std::size_t>(system.units()[u].states),
               members = static_cast<std::size_t>(system.units()[u].members());
    for (std::size_t i = 0; i < n; ++i) own.push_back(system.places(u)[i * members + i]);
  }
  return own;
}

}  // namespace segments

struct SegmentSolver::Parts {
  N_Vector y, yp;
  segments::Problem problem;
  segments::Owner<SUNMatrix, segments::FreeMatrix> matrix;
  segments::Owner<SUNLinearSolver, segments::FreeSolver> solver;
  std::unique_ptr<void, segments::FreeIda> ida;
};

SegmentSolver::SegmentSolver(SUNContext context, const ReferenceSystem& system, N_Vector y, N_Vector yp,
                             double start, double end, const ReferenceOptions& options, SeenEntries& seen)
    : parts_(new Parts{y,
                       yp,
                       {system, options, system.error_weights(), Nonzeros(system, seen),
                        std::vector<double>(static_cast<std::size_t>(system.pattern().nonZeros())),
                        segments::own_places(system)},
                       {},
                       {},
                       {}}),
      reached_(start) {
  auto& [to_y, to_yp, problem, matrix, solver, ida] = *parts_;
  matrix.reset(SUNSparseMatrix(system.size(), system.size(), system.size(), CSC_MAT, context));
  matrix->ops->zero = segments::keep;
  solver.reset(SUNLinSol_KLU(y, matrix.get(), context));
  problem.solver = solver.get();
  require(SUNLinSol_KLUSetOrdering(solver.get(), segments::kMinimumDegree), "SUNLinSol_KLUSetOrdering");
  ida.reset(IDACreate(context));
  problem.ida = ida.get();
  require(IDASetErrHandlerFn(ida.get(), segments::quiet, nullptr), "IDASetErrHandlerFn");
  require(IDAInit(ida.get(), segments::residual, start, y, yp), "IDAInit");
  require(IDASetUserData(ida.get(), &problem), "IDASetUserData");
  require(IDAWFtolerances(ida.get(), segments::error_weights), "IDAWFtolerances");
  require(IDASetLinearSolver(ida.get(), solver.get(), matrix.get()), "IDASetLinearSolver");
  require(IDASetJacFn(ida.get(), segments::jacobian), "IDASetJacFn");
  require(IDASetDeltaCjLSetup(ida.get(), segments::kFactorAnew), "IDASetDeltaCjLSetup");
  require(IDASetMaxNumSteps(ida.get(), 1'000'000), "IDASetMaxNumSteps");
  require(IDASetStopTime(ida.get(), end), "IDASetStopTime");
}

SegmentSolver::~SegmentSolver() = default;

bool SegmentSolver::advance(double t) {
  interruption_point();
  return IDASolve(parts_->ida.get(), t, &reached_, parts_->y, parts_->yp, IDA_NORMAL) >= 0;
}

long SegmentSolver::steps() const {
  long n = 0;
  IDAGetNumSteps(parts_->ida.get(), &n);
  return n;
}

}  // namespace swingbank::sim::reference
