#pragma once
// Fits in separate processes. A crash of a fit thus does not end the server, and a stop request reaches only
// one fit.
#include <functional>
#include <memory>

#include "base/json.hpp"

namespace swingbank::jobs {

/// Running fit in a separate process. Destruction asks it to end.
class FitProcess {
 public:
  /// Takes ownership of the socket to the process.
  explicit FitProcess(int socket) : socket_(socket) {}
  ~FitProcess();
  FitProcess(const FitProcess&) = delete;
  FitProcess& operator=(const FitProcess&) = delete;
  /// Waits for the next message and returns it; null after the last one.
  nlohmann::json next();
  /// Asks the fit to end with the values reached so far.
  void stop() const;

 private:
  int socket_;
};

/// Factory of fit processes: a copy of this process, forked before this process starts threads. The copy
/// forks once more for every fit.
class FitForks {
 public:
  /// Function that a fit process executes. Its arguments are the request and a function that sends messages.
  using Work = std::function<void(const nlohmann::json& request,
                                  const std::function<void(const nlohmann::json&)>& send)>;
  /// Forks the copy. No other thread may run, and this thread must not have used OpenMP.
  explicit FitForks(const Work& work);
  /// Ends the copy, and asks running fits to end.
  ~FitForks();
  FitForks(const FitForks&) = delete;
  FitForks& operator=(const FitForks&) = delete;
  /// Starts a fit. Throws InputError if the system allows no further process.
  [[nodiscard]] std::unique_ptr<FitProcess> start(const nlohmann::json& request) const;

 private:
  int control_ = -1;  ///< socket to the copy
};

}  // namespace swingbank::jobs
