#pragma once
// HTTP server of the live page: only on the loopback interface, protected by a random token, with independent
// sessions.
#include <functional>
#include <memory>
#include <string>

#include "base/json.hpp"
#include "jobs/fit_forks.hpp"
#include "validate/live/session.hpp"
#include "validate/report/assets.hpp"

namespace swingbank::jobs {

/// Parts of the page that the command supplies.
struct PageParts {
  std::shared_ptr<const validate::live::Setup> setup;  ///< inputs
  /// Return the step (validate/live/session.hpp) of the submitted model: `first` with the detected switching
  /// times, `submitted` with the fitted switching times. Both wait until the step is computed.
  std::function<std::shared_ptr<const validate::live::Step>()> first, submitted;
  /// Starts a fit (validate/live/fits.hpp).
  std::function<std::unique_ptr<FitProcess>(const nlohmann::json& request)> start_fit;
  /// Returns a function that formats the progress messages of a fit of the given kind.
  std::function<std::function<std::string(const nlohmann::json& message)>(const std::string& kind)> progress;
  /// Saves a step and returns the messages to the user.
  std::function<nlohmann::json(const validate::live::Session& session, int step)> save;
};

/// Server of the page.
class PageServer {
 public:
  /// Binds 127.0.0.1 at `port`; 0: any free port. Throws InputError if the port is in use.
  PageServer(PageParts parts, int port);
  ~PageServer();
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;
  /// Returns the page's address with its token.
  [[nodiscard]] std::string url() const;
  /// Answers requests until `stop` returns true.
  void run(const std::function<bool()>& stop);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Returns the page's file of that name; its text is empty if there is none.
validate::report::Asset page_file(std::string_view name);

}  // namespace swingbank::jobs
