#pragma once
// HTTP server of the live page: on the loopback interface only, behind a random token, with sessions that do
// not disturb one another.
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
  /// Return the submitted step, provisional and compared; wait until it is complete.
  std::function<std::shared_ptr<const validate::live::Step>()> first, submitted;
  /// Starts a fit (validate/live/fits.hpp).
  std::function<std::unique_ptr<FitProcess>(const nlohmann::json& request)> start_fit;
  /// Returns the progress text of a message of a fit.
  std::function<std::function<std::string(const nlohmann::json& message)>(const std::string& kind)> progress;
  /// Saves a step; returns the messages to the user.
  std::function<nlohmann::json(const validate::live::Session& session, int step)> save;
};

/// Server of the page.
class PageServer {
 public:
  /// Binds 127.0.0.1 at `port`; 0: a free one. Throws InputError if the port is in use.
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
