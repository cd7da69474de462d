#pragma once
// One run at a time in a folder, or several that share it: a flock on a file of its own, so that nothing a
// run replaces (the journal, a checkpoint) carries the lock with it.
#include <chrono>
#include <filesystem>
#include <string>

namespace swingbank {

/// What a refusal says: "<what> at <where> (process 12 on host a holds it): <remedy>".
struct LockWords {
  std::string what, where, remedy;
};

class RunLock {
 public:
  /// Whether others of the same kind may hold the lock at the same time.
  enum class Kind { alone, shared };

  /// Creates `file` if need be (its folder must exist), locks it and writes into it who holds it: process,
  /// host, Slurm job. A run that was just ended may take a moment to go, so a held lock is tried again for
  /// `patience`. Throws InputError naming the holder if the lock stays held, and with the system's reason if
  /// the file system does not lock files: such a folder is neither free nor in use.
  RunLock(std::filesystem::path file, LockWords words,
          std::chrono::milliseconds patience = std::chrono::seconds(5), Kind kind = Kind::alone);
  /// The lock falls when the last process that holds the file ends, however it ends; a child made by fork
  /// holds it too. The file stays, because a file that is removed could be locked by two.
  ~RunLock();
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;
  /// Removes the file, where nobody needs the lock any more: in a folder that is refused, or after the result
  /// stands. Leaves a file that was there before, unless `always`.
  void withdraw(bool always = false);

 private:
  void open();
  /// False if another process holds it.
  bool try_lock();
  [[nodiscard]] bool is_the_one_of_that_name() const;
  [[noreturn]] void refuse() const;
  void write_owner() const;

  std::filesystem::path file_;
  LockWords words_;
  Kind kind_;
  int fd_ = -1;
  bool created_ = false;
};

}  // namespace swingbank
