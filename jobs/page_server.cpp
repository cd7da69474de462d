#include "jobs/page_server.hpp"

#include <fmt/format.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <charconv>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <map>
#include <mutex>
#include <random>
#include <thread>

#include "validate/live/fits.hpp"
#include "validate/live/overview.hpp"
// Included last, because httplib defines the macro _res, which Eigen uses as a name.
#include <httplib.h>

namespace swingbank::jobs {
namespace {

using namespace validate;
using nlohmann::json;

constexpr std::size_t kMostBytes = 1 << 20;    ///< largest body of a request [bytes]
constexpr std::size_t kMostSessions = 16;      ///< most open pages; the least recently used one is closed
constexpr std::size_t kThreads = 256;          ///< most connections at the same time
constexpr int kIdle = 2;                       ///< time until an idle connection is closed [s]
constexpr std::size_t kMostMessages = 10'000;  ///< most messages kept for a page that does not read them

/// Returns a random word of 32 hexadecimal digits from the system's generator.
std::string random_word() {
  std::random_device device;
  std::string word;
  for (int k = 0; k < 4; ++k) word += fmt::format("{:08x}", device());
  return word;
}

/// Thread on which the comparisons of changed and fitted models run, one after another. With several threads,
/// each would have its own OpenMP thread pool.
class Worker {
 public:
  /// Runs `work` on the thread and returns its result.
  template <class Work>
  auto run(Work work) {
    std::packaged_task<decltype(work())()> task(std::move(work));
    auto result = task.get_future();
    {
      const std::lock_guard guard(lock_);
      queue_.emplace_back([&task] { task(); });
    }
    news_.notify_one();
    return result.get();
  }

 private:
  void work(const std::stop_token& ended) {
    while (true) {
      std::function<void()> next;
      {
        std::unique_lock guard(lock_);
        if (!news_.wait(guard, ended, [&] { return !queue_.empty(); })) return;
        next = std::move(queue_.front());
        queue_.pop_front();
      }
      next();
    }
  }
  std::mutex lock_;
  std::condition_variable_any news_;
  std::deque<std::function<void()>> queue_;
  std::jthread thread_{[this](const std::stop_token& ended) { work(ended); }};
};

/// One open page.
struct Page {
  explicit Page(std::shared_ptr<const live::Setup> setup, std::shared_ptr<const live::Step> submitted)
      : session(std::move(setup), std::move(submitted)) {}
  live::Session session;
  std::atomic<std::uint64_t> latest{0};  ///< sequence number of the newest preview
  std::mutex lock;                       ///< guards all members below
  std::condition_variable news;
  std::deque<std::string> messages;  ///< not yet sent to the page
  std::shared_ptr<FitProcess> fit;   ///< running fit
  std::chrono::steady_clock::time_point used = std::chrono::steady_clock::now();

  void send(const json& message) {
    const std::lock_guard guard(lock);
    if (messages.size() < kMostMessages) messages.push_back(json_text(message));
    news.notify_all();
  }
};

live::Values values_of(const json& body) {
  live::Values values;
  for (const auto& [name, value] : body.at("values").items()) values.emplace_back(name, value.get<double>());
  return values;
}

}  // namespace

struct PageServer::State {
  PageParts parts;
  std::string token = random_word();
  int port = 0, socket = -1;  ///< port and socket of the server
  httplib::Server http;
  std::mutex lock;
  std::map<std::string, std::shared_ptr<Page>> pages;
  std::atomic<int> readers{0};  ///< number of threads that read the messages of fits
  Worker worker;

  /// Returns whether a request comes from the page itself.
  [[nodiscard]] bool is_own(const httplib::Request& r) const {
    const std::array hosts = {fmt::format("127.0.0.1:{}", port), fmt::format("localhost:{}", port)};
    const std::string host = r.get_header_value("Host"), origin = r.get_header_value("Origin");
    if (std::ranges::count(hosts, host) == 0) return false;
    if (r.has_header("Origin") && origin != "http://" + host) return false;
    return r.path.starts_with("/" + token + "/");
  }
  std::shared_ptr<Page> page(const httplib::Request& r) {
    const std::lock_guard guard(lock);
    const auto found = pages.find(r.get_param_value("s"));
    if (found == pages.end())
      throw InputError({"unknown session", "the live page", "it was closed, or the server was started again",
                        "reload the page"});
    found->second->used = std::chrono::steady_clock::now();
    return found->second;
  }
  /// Returns the session of this name if it is open (after a reload of the page), else a new one.
  std::pair<std::string, std::shared_ptr<Page>> open(const std::string& known) {
    {
      const std::lock_guard guard(lock);
      if (const auto found = pages.find(known); found != pages.end()) return *found;
    }
    auto submitted = parts.first();
    auto page = std::make_shared<Page>(parts.setup, std::move(submitted));
    std::shared_ptr<Page> closed;  // destroyed after the lock is released
    const std::lock_guard guard(lock);
    if (pages.size() >= kMostSessions) {
      const auto oldest = std::ranges::min_element(pages, {}, [](const auto& p) { return p.second->used; });
      closed = oldest->second;
      const std::lock_guard of_page(closed->lock);
      if (closed->fit) closed->fit->stop();
      pages.erase(oldest);
    }
    const std::string name = random_word();
    pages.emplace(name, page);
    return {name, page};
  }

  static int whole(const httplib::Request& r, const char* name) {
    const std::string text = r.get_param_value(name);
    int value = -1;
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
  }
  static void reply(httplib::Response& out, const json& content) {
    out.set_content(json_text(content), "application/json");
  }
  static void reply(httplib::Response& out, const std::vector<float>& content) {
    out.set_content(reinterpret_cast<const char*>(content.data()), content.size() * sizeof(float),
                    "application/octet-stream");
  }

  void preview(const httplib::Request& r, httplib::Response& out) {
    const auto of = page(r);
    const json body = json::parse(r.body);
    const auto number = body.at("seq").get<std::uint64_t>();
    std::uint64_t latest = of->latest;
    while (latest < number && !of->latest.compare_exchange_weak(latest, number)) {
    }
    if (of->latest > number) {  // a newer slider position has arrived
      out.status = 204;
      return;
    }
    const auto step = of->session.step(body.at("step"));
    const auto event = body.at("event").get<std::size_t>();
    const live::Preview shown = live::preview(*step, event, values_of(body));
    reply(out, live::preview_floats(shown, step->played->events[event]));
  }
  void ribbon(const httplib::Request& r, httplib::Response& out) {
    const auto of = page(r);
    const json body = json::parse(r.body);
    const auto step = of->session.step(body.at("step"));
    reply(out, live::ribbon(*step, body.at("event"), values_of(body), body.at("name")));
  }
  void change(const httplib::Request& r, httplib::Response& out) {
    const auto of = page(r);
    const json body = json::parse(r.body);
    const int k = worker.run([&] { return of->session.change(body.at("step"), values_of(body)); });
    reply(out, live::step_json(*parts.setup, *of->session.step(k), k));
  }

  /// Reads the messages of a fit until its end. A new model becomes a step of the session.
  void follow(const std::shared_ptr<Page>& of, const std::shared_ptr<FitProcess>& fit, const json& request) {
    const auto progress = parts.progress(request.at("kind"));
    bool ended = false;
    for (json message = fit->next(); !message.is_null(); message = fit->next()) {
      try {
        const std::string type = message.at("type");
        if (type == "progress") {
          message["text"] = progress(message);
        } else if (type == "step") {
          const int parent = request.at("step");
          const int k = worker.run([&] {
            return of->session.append(
                live::step_of_fit(*parts.setup, *of->session.step(parent), parent, message));
          });
          message = live::step_json(*parts.setup, *of->session.step(k), k);
          message["type"] = "step";
        } else if (type == "diagnosis") {
          of->session.diagnosed(request.at("step"), message.at("sentence"));
        }
        ended = ended || type == "step" || type == "end" || type == "failed";
      } catch (const std::exception& error) {
        message = {{"type", "failed"}, {"text", error.what()}};
        ended = true;
      }
      of->send(message);
    }
    if (!ended)
      of->send({{"type", "failed"}, {"text", "The fit ended without a result; the model is unchanged."}});
    const std::lock_guard guard(of->lock);
    of->fit.reset();
  }
  void start_fit(const httplib::Request& r, httplib::Response& out) {
    const auto of = page(r);
    json request = json::parse(r.body);
    const auto step = of->session.step(request.at("step"));
    const std::lock_guard guard(of->lock);
    if (of->fit)
      throw InputError(
          {"a second fit", "the live page", "a fit is already running", "stop it, or wait until it ends"});
    request["plant"] = live::plant_json(step->model);
    of->fit = parts.start_fit(request);
    ++readers;
    std::thread([this, of, fit = of->fit, request] {
      follow(of, fit, request);
      --readers;
      readers.notify_all();
    }).detach();
    reply(out, {{"started", true}});
  }
  void stream(const httplib::Request& r, httplib::Response& out) {
    out.set_header("Cache-Control", "no-store");
    out.set_chunked_content_provider(
        "text/event-stream", [of = page(r)](std::size_t, httplib::DataSink& sink) {
          std::deque<std::string> messages;
          {
            std::unique_lock guard(of->lock);
            of->news.wait_for(guard, std::chrono::seconds(1), [&] { return !of->messages.empty(); });
            messages.swap(of->messages);
          }
          std::string text = messages.empty() ? ": still here\n\n" : "";
          for (const auto& m : messages) text += "data: " + m + "\n\n";
          return sink.write(text.data(), text.size());
        });
  }

  void routes();
};

void PageServer::State::routes() {
  using httplib::Request, httplib::Response;
  http.set_payload_max_length(kMostBytes);
  http.set_keep_alive_max_count(1'000'000);
  http.set_keep_alive_timeout(kIdle);
  http.set_read_timeout(kIdle);
  http.set_tcp_nodelay(true);
  http.set_socket_options([this](int made) {
    httplib::default_socket_options(made);
    socket = made;
  });
  http.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
  http.set_default_headers({{"X-Content-Type-Options", "nosniff"},
                            {"Referrer-Policy", "no-referrer"},
                            {"Cross-Origin-Resource-Policy", "same-origin"},
                            {"X-Frame-Options", "DENY"},
                            {"Content-Security-Policy",
                             "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data:; "
                             "frame-ancestors 'none'"}});
  http.set_pre_routing_handler([this](const Request& r, Response& out) {
    if (is_own(r)) return httplib::Server::HandlerResponse::Unhandled;
    out.status = 403;
    out.set_content("Refused: open the address that swingbank serve has printed, with its token.\n",
                    "text/plain");
    return httplib::Server::HandlerResponse::Handled;
  });
  http.set_exception_handler([](const Request&, Response& out, const std::exception_ptr& failure) {
    out.status = 400;
    std::string text = "the request failed";
    try {
      std::rethrow_exception(failure);
    } catch (const std::exception& error) {
      text = error.what();
    } catch (...) {
    }
    reply(out, {{"error", text}});
  });
  const std::string at = "/" + token;
  const auto api = [&](const std::string& name) { return at + "/api/" + name; };
  const auto file = [](const std::string& name, Response& out) {
    report::Asset f = page_file(name);
    if (f.text.empty()) f = report::asset(name);
    if (f.text.empty()) {
      out.status = 404;
      return;
    }
    const auto is = [&](const char* end) { return name.ends_with(end); };
    out.set_content(f.text.data(), f.text.size(),
                    is(".js")    ? "text/javascript"
                    : is(".css") ? "text/css"
                    : is(".svg") ? "image/svg+xml"
                                 : "text/html; charset=utf-8");
  };
  http.Get(at + "/", [file](const Request&, Response& out) { file("index.html", out); });
  http.Get(at + R"(/page/([A-Za-z0-9._-]+))",
           [file](const Request& r, Response& out) { file(r.matches[1], out); });
  http.Post(api("open"), [this](const Request& r, Response& out) {
    const json body = r.body.empty() ? json::object() : json::parse(r.body);
    const auto [name, of] = open(body.value("session", ""));
    const auto step = of->session.step(0);
    json later = json::array();
    for (const int k : of->session.kept())
      if (k > 0) later.push_back(live::step_json(*parts.setup, *of->session.step(k), k));
    reply(out, {{"session", name},
                {"setup", live::setup_json(*parts.setup, *step)},
                {"step", live::step_json(*parts.setup, *step, 0)},
                {"steps", later}});
  });
  http.Get(api("submitted"), [this](const Request& r, Response& out) {
    const auto of = page(r);
    const auto step = parts.submitted();
    of->session.compared(step);
    reply(out, {{"setup", live::setup_json(*parts.setup, *step)},
                {"step", live::step_json(*parts.setup, *step, 0)}});
  });
  http.Get(api("step"), [this](const Request& r, Response& out) {
    const int k = whole(r, "k");
    reply(out, live::step_json(*parts.setup, *page(r)->session.step(k), k));
  });
  http.Get(api("curves"), [this](const Request& r, Response& out) {
    const int event = whole(r, "e");
    const auto step = page(r)->session.step(whole(r, "k"));
    if (event < 0 || event >= static_cast<int>(step->played->events.size()))
      throw InputError(
          {"unknown event", "the live page", "the model has no event of this number", "reload the page"});
    reply(out, live::curves(*step, static_cast<std::size_t>(event)));
  });
  http.Get(api("effects"), [this](const Request& r, Response& out) {
    reply(out, live::effects_json(*page(r)->session.step(whole(r, "k"))));
  });
  http.Post(api("preview"), [this](const Request& r, Response& out) { preview(r, out); });
  http.Post(api("ribbon"), [this](const Request& r, Response& out) { ribbon(r, out); });
  http.Post(api("change"), [this](const Request& r, Response& out) { change(r, out); });
  http.Post(api("fit"), [this](const Request& r, Response& out) { start_fit(r, out); });
  http.Post(api("stop"), [this](const Request& r, Response& out) {
    const auto of = page(r);
    const std::lock_guard guard(of->lock);
    if (of->fit) of->fit->stop();
    reply(out, {{"stopped", true}});
  });
  http.Get(api("stream"), [this](const Request& r, Response& out) { stream(r, out); });
  http.Post(api("save"), [this](const Request& r, Response& out) {
    reply(out, parts.save(page(r)->session, json::parse(r.body).at("step")));
  });
}

PageServer::PageServer(PageParts parts, int port) : state_(std::make_unique<State>()) {
  state_->parts = std::move(parts);
  state_->routes();  // sets the socket options, which must be known before the socket is created
  const char* const here = "127.0.0.1";
  if (port == 0)
    state_->port = state_->http.bind_to_any_port(here);
  else if (state_->http.bind_to_port(here, port))
    state_->port = port;
  if (state_->port <= 0)
    throw InputError({fmt::format("port {}", port), "--port", "another program uses it",
                      "choose another one, or leave --port out"});
  // httplib's queue holds 5 connections only. A browser repeats a dropped connection only after a second.
  ::listen(state_->socket, static_cast<int>(kThreads));
}

PageServer::~PageServer() = default;

std::string PageServer::url() const {
  return fmt::format("http://127.0.0.1:{}/{}/", state_->port, state_->token);
}

void PageServer::run(const std::function<bool()>& stop) {
  std::jthread watch([&](const std::stop_token& ended) {
    while (!stop() && !ended.stop_requested()) std::this_thread::sleep_for(std::chrono::milliseconds(50));
    state_->http.stop();
  });
  state_->http.listen_after_bind();
  watch.request_stop();
  watch.join();
  {
    const std::lock_guard guard(state_->lock);
    for (const auto& [name, page] : state_->pages) {
      const std::lock_guard of_page(page->lock);
      if (page->fit) page->fit->stop();
    }
  }
  for (int left = state_->readers; left > 0; left = state_->readers) state_->readers.wait(left);
}

}  // namespace swingbank::jobs
