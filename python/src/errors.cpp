// Translation of the library's exceptions: InputError with its list of problems, and KeyboardInterrupt.
#include <unistd.h>

#include "python/src/interruptible.hpp"
#include "python/src/native.hpp"

namespace swingbank::python {
namespace {

/// Raises swingbank.InputError with (what, where, why, do) of each problem.
void raise(const InputError& error) {
  py::list problems;
  for (const Problem& p : error.problems())
    problems.append(py::make_tuple(shown(p.what), shown(p.where), shown(p.why), shown(p.remedy)));
  const py::object type = py::module_::import("swingbank.errors").attr("InputError");
  PyErr_SetObject(type.ptr(), type(problems).ptr());
}

/// Runs Python's handler of Ctrl-C in the main thread. Raises KeyboardInterrupt if the handler raises
/// nothing.
void raise_interrupt() {
  if (::gettid() == ::getpid()) PyErr_SetInterrupt();
  if (PyErr_CheckSignals() == 0) PyErr_SetNone(PyExc_KeyboardInterrupt);
}

}  // namespace

event::Progress progress_of(const std::shared_ptr<Callback>& callback) {
  if (!callback || !callback->given()) return {};
  return [callback](event::Phase phase, const std::string& item, int done, int total) {
    (*callback)(std::string(event::phase_words(phase)), item, done, total);
  };
}

void bind_errors(py::module_&) {
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const InputError& error) {
      raise(error);
    } catch (const Interrupted&) {
      raise_interrupt();
    }
  });
}

}  // namespace swingbank::python
