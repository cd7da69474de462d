#pragma once
// Exclusive or shared lock on a folder, by flock(2) on a separate file. A lock on the journal or checkpoint
// would be lost, because a run replaces these files.
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
  /// `alone`: exclusive lock; `shared`: lock that several holders of kind `shared` hold at the same time.
  enum class Kind { alone, shared };

  /// Creates `file` if it is missing (its folder must exist), locks it and writes the holder into it:
  /// process, host, Slurm job. If another process holds the lock, retries for `patience`, because that
  /// process may be exiting. Then throws InputError with the holder. If the file system does not support
  /// locks, throws InputError with the system's error text.
  RunLock(std::filesystem::path file, LockWords words,
          std::chrono::milliseconds patience = std::chrono::seconds(5), Kind kind = Kind::alone);
  /// Releases the lock. The kernel also releases it when the last process with the open file ends, in any
  /// way; a forked child inherits the lock. The file remains: after a removal, one process could lock the
  /// removed file and another process a new file of the same name.
  ~RunLock();
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;
  /// Removes the file if this object created it or `always` is true. Call it only for a folder that no later
  /// run locks: one that the command has rejected, or one with complete results.
  void withdraw(bool always = false);

 private:
  void open();
  /// Returns false if another process holds the lock.
  bool try_lock();
  [[nodiscard]] bool still_has_its_name() const;
  [[noreturn]] void refuse() const;
  void write_owner() const;

  std::filesystem::path file_;
  LockWords words_;
  Kind kind_;
  int fd_ = -1;
  bool created_ = false;
};

}  // namespace swingbank
