#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "calib/files/schema/session_script.h"
#include "calib/model/rig.h"
#include "calib/model/session.h"
#include "calib/model/view_detection.h"

namespace rgbdt {

/// What a session that was ended before its end, or killed, left in its folder. A view counts once
/// its detection lies beside it (views/0001/detection.lcm: the DETECTION message as it came), so
/// that whoever goes on tells the solver the same, to the bit.
struct EarlierViews {
  std::map<std::string, ViewDetection> detected;  ///< by view
  std::set<std::string> undetected;               ///< folders of views that do not count
  std::optional<LeftOutViews> left_out;
  /// What it asked for last, of a view; absent: too long ago, or that is not known.
  std::optional<SessionCommand> asked;

  bool empty() const { return detected.empty() && undetected.empty(); }
  int NewestNumber() const;   ///< of a view whose name is a number; 0: there is none
  Utime NewestUtime() const;  ///< of what the sensors gave for them
};

/// What it asked for longer ago nobody is still at [s].
inline constexpr int kAskedIsOld = 300;

/// Empty where the folder holds no views, or is not there. Throws InputError, with what differs,
/// where the views are of another rig; where the session has ended (WriteEnded); and where a
/// file cannot be read.
EarlierViews ReadEarlierViews(const std::filesystem::path& directory, const Rig& rig);

/// "0007"
std::string ViewName(int number);

/// Where a script goes on.
struct ResumePoint {
  std::size_t step = 0;  ///< the first that is still to be done
  int view_number = 0;   ///< of the newest view that there is
  /// A view that is on disk and was not detected: it is taken again; empty: there is none.
  std::string unfinished;
  /// `step` was asked for and is still to be answered, or was and nobody heard.
  bool asked = false;
};

/// After the script's last capture of which all views up to it are there; at the step after it that
/// was asked for, if one was. Throws InputError, with what differs, where the views are not those
/// that the script takes, or nothing is left to do.
ResumePoint FindResumePoint(const SessionScript& script, const EarlierViews& views,
                            const std::filesystem::path& directory);

/// Of a session that a person leads: the view that it was asked for, if one was.
ResumePoint FindResumePoint(const EarlierViews& views);

/// Beside the view; whole or not at all. Throw InputError.
void WriteDetection(const std::filesystem::path& directory, const ViewDetection& detection);
void WriteLeftOut(const std::filesystem::path& directory, const LeftOutViews& left_out);

/// Before a command of a view is sent: a session that is killed goes on waiting for its answer
/// (EarlierViews::asked). Throws InputError.
void WriteAsked(const std::filesystem::path& directory, const SessionCommand& command);
/// Nobody is to wait for it.
void RemoveAsked(const std::filesystem::path& directory);

/// The session was saved and is not to be gone on with: a file `ended`. Throws InputError.
void WriteEnded(const std::filesystem::path& directory);

/// What a session whose views are gone left beside them is not taken for a new one's. Throws
/// InputError.
void RemoveTraces(const std::filesystem::path& directory);

}  // namespace rgbdt
