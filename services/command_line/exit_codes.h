#pragma once

#include <map>
#include <string>

namespace rgbdt {

/// How every program of rgbdt ends, for scripts that run it. New ones get a number of their own:
/// what a number means does not change.
enum class ExitCode : int {
  kDone = 0,      ///< all that was asked for
  kFailed = 1,    ///< not all of it; or the verdict that a verb is for is "no"
  kUsage = 2,     ///< the command line makes no sense; nothing was done
  kDoubtful = 3,  ///< done, and the verdict is `doubtful`: something does not fit together
  kDoNotUse = 4,  ///< done, and the verdict is `do not use`
};

/// What `--help` says of them unless a program or verb says more.
inline std::map<ExitCode, std::string> UsualEnds() {
  return {{ExitCode::kDone, "done"},
          {ExitCode::kFailed, "failed; stderr says why"},
          {ExitCode::kUsage, "wrong usage: an option, its value, or one that is missing"}};
}

/// Of a verb that ends well or not.
inline ExitCode EndsIf(bool good) { return good ? ExitCode::kDone : ExitCode::kFailed; }
inline int EndsWith(bool good) { return static_cast<int>(EndsIf(good)); }

}  // namespace rgbdt
