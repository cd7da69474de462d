// swingbank serve: the live page, on which a plant model is compared, changed, diagnosed and completed.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <future>
#include <mutex>
#include <thread>

#include "base/child.hpp"
#include "base/json.hpp"
#include "base/output_folder.hpp"
#include "jobs/analysis_options.hpp"
#include "jobs/fit_forks.hpp"
#include "jobs/page_server.hpp"
#include "jobs/progress_plan.hpp"
#include "validate/live/fits.hpp"
#include "validate/live/save.hpp"

namespace swingbank::jobs::serve_command {
namespace {

using namespace validate;
using nlohmann::json;

struct Command {
  jobs::AnalysisOptions of{"live"};
  int port = 0;
  bool open = false;
};

std::shared_ptr<live::Setup> read_setup(Command& c) {
  c.of.judging.read();
  auto s = std::make_shared<live::Setup>();
  s->model = c.of.load_model(true);
  const check::Preparing preparing = c.of.reading.apply(s->model, c.of.records);
  check::RecordSet set = jobs::read_events(c.of.records, s->model, preparing);
  s->records = c.of.compared(std::move(set.records));
  s->warnings = std::move(set.warnings);
  s->compare = c.of.comparing();
  s->measured = compare::measurements(s->records, s->compare, s->model.plant.mva);
  s->events = c.of.events();
  s->by = c.of.judging.by;
  s->prior_sd = c.of.prior_sd;
  s->threads = std::max(c.of.threads, 0);
  s->options = c.of.inputs();
  s->plant_file = c.of.model;
  return s;
}

/// Returns a function that formats the progress messages of one fit.
std::function<std::string(const json&)> progress_text(const std::string& kind) {
  const jobs::ProgressPlan& plan = kind == "diagnose" ? jobs::kDiagnosePlan
                                   : kind == "add"    ? jobs::kAddPlan
                                                      : jobs::kCalibratePlan;
  using Clock = std::chrono::steady_clock;
  return [at = std::make_shared<jobs::PlannedProgress>(plan), start = Clock::now()](const json& m) {
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    return at->line(static_cast<jobs::Phase>(m.at("phase").get<int>()), m.at("item"), m.at("done"),
                    m.at("total"), seconds);
  };
}

/// Opens the page in the user's browser.
void open_browser(const std::string& url) {
  try {
    run_program("/usr/bin/xdg-open", {"xdg-open", url}, {.silent = true});
  } catch (const InputError&) {
    fmt::print(stderr, "note: no browser was opened; open the address above\n");
  }
}

int run(Command& c) {
  // Read in a temporary thread, because reading may use OpenMP, whose threads would not survive the fork
  // below.
  auto reading = std::async(std::launch::async, [&] { return read_setup(c); });
  const std::shared_ptr<live::Setup> setup = reading.get();
  const jobs::FitForks forks([&](const json& request, const auto& send) {
    c.of.limit_threads();
    live::run_fit(*setup, request, send);
  });
  using Submitted = std::shared_future<std::shared_ptr<const live::Step>>;
  const auto compared = [&](auto step_of) {
    return [&setup, step_of] { return std::make_shared<const live::Step>(step_of(*setup)); };
  };
  const Submitted first = std::async(std::launch::async, compared(live::first_step));
  // Comparison with fitted switching times. It starts only when the page requests it after showing the first
  // step, so that it does not take processor time from the browser.
  Submitted submitted;
  std::once_flag asked;
  jobs::PageParts parts;
  parts.setup = setup;
  parts.first = [&] { return first.get(); };
  parts.submitted = [&] {
    std::call_once(asked,
                   [&] { submitted = std::async(std::launch::async, compared(live::submitted_step)); });
    return submitted.get();
  };
  parts.start_fit = [&](const json& request) { return forks.start(request); };
  parts.progress = progress_text;
  parts.save = [&](const live::Session& session, int step) {
    const bool replaced =
        std::filesystem::exists(std::filesystem::path(c.of.out) / live::saved_files().front());
    OutputFolder folder(c.of.out, "serve", live::saved_files(), c.of.judging.outputs());
    report::Provenance provenance = {{"software", fmt::format("swingbank {}", jobs::version())},
                                     {"model", c.of.model}};
    jobs::sign(provenance, c.of.judging, c.of.model, c.of.records);
    json saved = live::save(session, step, folder, provenance);
    saved["replaced"] = replaced;
    folder.finish();
    if (!c.of.judging.pdf.empty()) {
      c.of.judging.print(folder.path() / "report.html");
      saved["files"].push_back(c.of.judging.pdf);
    }
    return saved;
  };
  jobs::PageServer server(std::move(parts), c.port);
  fmt::print("{}\n", server.url());
  std::fflush(stdout);
  if (!jobs::quiet) fmt::print(stderr, "The live page is at the URL above; Ctrl-C stops it.\n");
  std::jthread opening;
  if (c.open) opening = std::jthread(open_browser, server.url());
  server.run(stop_asked);
  return 0;
}

void declare(jobs::CommandLine& line, Command& c) {
  c.of.declare(line, "the files that the page saves: model.toml, model.dyr, model.dyd and report.html");
  c.of.declare_fit(line);
  line.group("Page");
  line.add("--port", c.port, "port on 127.0.0.1 (default: a free one)").between(0, 65535);
  line.add_flag("--open", c.open, "open the page in your browser");
  line.example("swingbank serve --model plant.toml --records fault1.csv fault2.csv --open");
  line.footer(
      "Prints the page's URL, which contains a random access token. Listens on 127.0.0.1 only. Ctrl-C or SIGTERM "
      "stops it. Exit codes: 0 stopped by a signal, 1 an error that was printed.");
}

}  // namespace

int run(CommandLine& line, int argc, char** argv) {
  interrupt_on_stop_signals();
  Command c;
  declare(line, c);
  if (!line.parse(argc, argv)) return line.end();
  if (c.of.model.empty()) return line.lacks("--model with --records");
  return run(c);
}

}  // namespace swingbank::jobs::serve_command
