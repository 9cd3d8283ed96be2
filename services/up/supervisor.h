#pragma once

#include <sys/types.h>

#include <functional>
#include <string>
#include <vector>

#include "calib/model/time.h"
#include "services/up/rig_programs.h"

namespace rgbdt {

/// Runs programs as children, and again where one ends, for as long as it takes: at once first,
/// then after a pause that doubles from kFirstPause to kLongestPause, until it has run for kSound.
/// Children end with whoever made this, killed or not. One thread uses it, the one that made it.
class Supervisor {
 public:
  static constexpr Utime kFirstPause = kMicrosecondsPerSecond / 2;
  static constexpr Utime kLongestPause = 30 * kMicrosecondsPerSecond;
  static constexpr Utime kSound = 10 * kMicrosecondsPerSecond;
  static constexpr Utime kPatience = 5 * kMicrosecondsPerSecond;  ///< until SIGKILL follows SIGTERM

  struct Child {
    Program program;
    pid_t pid = 0;             ///< 0: it does not run
    bool done = false;         ///< it ended as it was to, and is not started again
    int starts = 0;            ///< how often it was started
    std::string how_it_ended;  ///< the newest time; empty: it has not
    Utime started = 0, next_start = 0;
    int failures = 0;  ///< in a row
  };
  /// Told what happens, a line each: "detector: started, pid 77".
  using Tell = std::function<void(const std::string& line)>;

  /// Throws InputError where a log cannot be written.
  Supervisor(std::vector<Program> programs, Tell tell);
  ~Supervisor() { Stop(); }
  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;

  /// The pause before the next start after so many failures in a row.
  static Utime PauseAfter(int failures);

  /// It is `now` [us] of a steady clock: starts what is due, notices what has ended.
  void Advance(Utime now);
  /// Ends all: SIGTERM, after kPatience SIGKILL. Waits for it.
  void Stop();
  const std::vector<Child>& children() const { return children_; }

 private:
  void Start(Child* child, Utime now);
  void Ended(Child* child, int status, Utime now);

  std::vector<Child> children_;
  Tell tell_;
};

}  // namespace rgbdt
