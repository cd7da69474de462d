#pragma once
// Exclusive or shared lock on a folder: flock(2) on a separate file, because a run replaces other files
// (journal, checkpoint), and a lock on them would be lost.
#include <chrono>
#include <filesystem>
#include <string>

namespace swingbank {

/// Parts of the error message for a lock held by another process: "<what> at <where> (locked by process 12
/// on host a): <remedy>".
struct LockWords {
  std::string what, where, remedy;  ///< the message without its reason
};

/// Lock on a folder, held from construction to destruction.
class RunLock {
 public:
  /// Exclusive lock, or a lock that several holders of this kind share.
  enum class Kind { alone, shared };

  /// Creates `file` if it is missing (its folder must exist), locks it and writes the holder into it:
  /// process, host, Slurm job. Retries a held lock for `patience`, because a run that was just ended may
  /// still be exiting. Throws InputError with the holder if the lock stays held, and with the system's error
  /// text if the file system does not support locks.
  RunLock(std::filesystem::path file, LockWords words,
          std::chrono::milliseconds patience = std::chrono::seconds(5), Kind kind = Kind::alone);
  /// Releases the lock. The kernel also releases it when the last process with the open file ends, in any
  /// way; a forked child inherits the lock. The file remains, because two processes could each lock a removed
  /// and recreated file.
  ~RunLock();
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;
  /// Removes the file if this object created it, or always with `always`. For folders that no run locks any
  /// more: a refused folder, or a folder with complete results.
  void withdraw(bool always = false);

 private:
  void open();
  /// Returns false if another process holds the lock.
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
