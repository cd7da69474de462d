#include "jobs/fit_forks.hpp"

#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <thread>

#include "base/child.hpp"
#include "base/problem.hpp"
#include "base/stop_signal.hpp"
#include "base/until_done.hpp"

namespace swingbank::jobs {
namespace {

constexpr char kStop = 's';

/// Writes all bytes. Returns false if the other end is closed.
bool write_all(int socket, const char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t n = until_done([&] { return ::send(socket, data, size, MSG_NOSIGNAL); });
    if (n <= 0) return false;
    data += n;
    size -= static_cast<std::size_t>(n);
  }
  return true;
}
bool read_all(int socket, char* data, std::size_t size) {
  while (size > 0) {
    const ssize_t n = until_done([&] { return ::recv(socket, data, size, 0); });
    if (n <= 0) return false;
    data += n;
    size -= static_cast<std::size_t>(n);
  }
  return true;
}

/// Writes a message, preceded by its length. Returns false if the other end is closed.
bool write_message(int socket, const nlohmann::json& message) {
  const std::string text = json_text(message);
  const auto size = static_cast<std::uint32_t>(text.size());
  return write_all(socket, reinterpret_cast<const char*>(&size), sizeof size) &&
         write_all(socket, text.data(), text.size());
}
nlohmann::json read_message(int socket) {
  std::uint32_t size = 0;
  if (!read_all(socket, reinterpret_cast<char*>(&size), sizeof size)) return nullptr;
  std::string text(size, '\0');
  if (!read_all(socket, text.data(), size)) return nullptr;
  return nlohmann::json::parse(text, nullptr, false);
}

/// Message of one byte that transfers a socket to another process.
struct SocketMessage {
  SocketMessage() {
    header.msg_iov = &data;
    header.msg_iovlen = 1;
    header.msg_control = buffer.data();
    header.msg_controllen = buffer.size();
  }
  SocketMessage(const SocketMessage&) = delete;  // the header refers to the other members
  SocketMessage& operator=(const SocketMessage&) = delete;

  char byte = 0;
  iovec data{&byte, 1};
  alignas(cmsghdr) std::array<char, CMSG_SPACE(sizeof(int))> buffer{};
  msghdr header{};
};

/// Sends a socket to the process at the other end of `control`. Returns false if that process has ended.
bool send_socket(int control, int socket) {
  SocketMessage message;
  cmsghdr* head = CMSG_FIRSTHDR(&message.header);
  head->cmsg_level = SOL_SOCKET;
  head->cmsg_type = SCM_RIGHTS;
  head->cmsg_len = CMSG_LEN(sizeof(int));
  std::memcpy(CMSG_DATA(head), &socket, sizeof socket);
  return until_done([&] { return ::sendmsg(control, &message.header, MSG_NOSIGNAL); }) == 1;
}
/// Receives a socket; none if the other end is closed.
std::optional<int> receive_socket(int control) {
  SocketMessage message;
  if (until_done([&] { return ::recvmsg(control, &message.header, 0); }) != 1) return {};
  const cmsghdr* head = CMSG_FIRSTHDR(&message.header);
  if (head == nullptr || head->cmsg_type != SCM_RIGHTS) return {};
  int socket = -1;
  std::memcpy(&socket, CMSG_DATA(head), sizeof socket);
  return socket;
}

/// Runs one fit; does not return.
[[noreturn]] void run_fit(const FitForks::Work& work, int socket) {
  interrupt_on_stop_signals();
  std::signal(SIGINT, SIG_IGN);  // Ctrl-C ends the server, which then closes the socket
  swingbank::detail::first_rank = 0;
  const nlohmann::json request = read_message(socket);
  if (!request.is_object()) ::_exit(1);
  std::thread([socket] {  // a byte, or the closing of the socket, ends the fit
    char word = 0;
    (void)until_done([&] { return ::recv(socket, &word, 1, 0); });
    swingbank::detail::stop_asked = 1;
  })
      .detach();
  work(request, [socket](const nlohmann::json& message) { write_message(socket, message); });
  ::_exit(0);
}

/// Forks a process for each socket until the server ends; does not return.
[[noreturn]] void serve_forks(const FitForks::Work& work, int control) {
  std::signal(SIGINT, SIG_IGN);
  std::signal(SIGTERM, SIG_IGN);
  std::signal(SIGCHLD, SIG_IGN);  // no zombies
  while (const auto socket = receive_socket(control)) {
    const pid_t child = ::fork();
    if (child == 0) {
      std::signal(SIGCHLD, SIG_DFL);
      ::close(control);
      run_fit(work, *socket);
    }
    ::close(*socket);  // if the fork failed, the server reads end-of-file, as after a fit
  }
  ::_exit(0);
}

[[noreturn]] void cannot_fork() {
  throw InputError(
      {"cannot start a fit", "this machine", std::strerror(errno), "close other programs, and try again"});
}

}  // namespace

FitProcess::~FitProcess() { ::close(socket_); }

nlohmann::json FitProcess::next() { return read_message(socket_); }

void FitProcess::stop() const { write_all(socket_, &kStop, 1); }

FitForks::FitForks(const Work& work) {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) cannot_fork();
  const pid_t copy = ::fork();
  if (copy == 0) {
    ::close(ends[0]);
    serve_forks(work, ends[1]);
  }
  ::close(ends[1]);
  control_ = ends[0];
  if (copy < 0) cannot_fork();
}

FitForks::~FitForks() { ::close(control_); }

std::unique_ptr<FitProcess> FitForks::start(const nlohmann::json& request) const {
  std::array<int, 2> ends{};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) cannot_fork();
  auto process = std::make_unique<FitProcess>(ends[0]);
  const bool sent = send_socket(control_, ends[1]);
  ::close(ends[1]);
  if (!sent || !write_message(ends[0], request)) cannot_fork();
  return process;
}

}  // namespace swingbank::jobs
