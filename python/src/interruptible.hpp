#pragma once
// Calls of the library without Python's global interpreter lock: other Python threads run meanwhile, and
// Ctrl-C ends the work.
#include <pybind11/pybind11.h>

#include <exception>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "base/stop_signal.hpp"
#include "validate/event/progress.hpp"

namespace swingbank::python {

namespace py = pybind11;

/// Python function that can be called from any thread. If it raises an exception, the work ends, and
/// without_lock() raises the exception.
class Callback {
 public:
  /// `function`: Python function, or None for no call.
  explicit Callback(py::object function) : function_(std::move(function)) {}
  Callback(const Callback&) = delete;
  Callback& operator=(const Callback&) = delete;
  ~Callback() {
    const py::gil_scoped_acquire lock;
    function_ = py::object();
    raised_.reset();
  }
  /// Returns whether there is a function.
  [[nodiscard]] bool given() const { return given_; }
  /// Calls the function with Python's lock held.
  template <class... Arguments>
  void operator()(const Arguments&... arguments) {
    const py::gil_scoped_acquire lock;
    if (raised_) return;
    try {
      function_(arguments...);
    } catch (py::error_already_set& error) {
      raised_ = std::make_unique<py::error_already_set>(std::move(error));
      ask_to_stop();
    }
  }
  /// Raises the function's exception, if any.
  void raise() {
    if (!raised_) return;
    py::error_already_set error = std::move(*raised_);
    raised_.reset();
    throw error;
  }

 private:
  py::object function_;
  bool given_ = !function_.is_none();
  std::unique_ptr<py::error_already_set> raised_;
};

/// Returns the library's progress function, which calls `callback(phase, item, done, total)`.
validate::event::Progress progress_of(const std::shared_ptr<Callback>& callback);

/// Python functions that a call of the library may use.
using Callbacks = std::vector<std::shared_ptr<Callback>>;

/// Runs `work` without Python's lock. Throws Interrupted after Ctrl-C, or the exception of a callback.
template <class Work>
auto without_lock(Work work, const Callbacks& callbacks = {}) {
  const InterruptOnSigint guard;
  try {
    auto result = [&] {
      const py::gil_scoped_release released;
      return work();
    }();
    for (const auto& callback : callbacks) callback->raise();
    interruption_point();
    return result;
  } catch (const Interrupted&) {
    for (const auto& callback : callbacks) callback->raise();
    throw;
  }
}

}  // namespace swingbank::python
