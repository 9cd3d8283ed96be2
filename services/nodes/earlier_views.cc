#include "services/nodes/earlier_views.h"

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "calib/files/atomic_file.h"
#include "calib/files/own_folder.h"
#include "calib/files/schema/rig_file.h"
#include "calib/files/session/session_dir.h"
#include "calib/model/errors.h"
#include "services/messages/codec.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;

constexpr const char* kDetectionFile = "detection.lcm";
constexpr const char* kLeftOutFile = "left_out_views.lcm";
constexpr const char* kAskedFile = "asked.lcm";
constexpr const char* kEndedFile = "ended";  // report.json does not tell: others write it, too
constexpr const char* kWayOut = "name another directory (--out)";

template <typename T>
T ReadMessage(const fs::path& path) {
  const std::string bytes = ReadWholeFile(path);
  try {
    const Message message =
        Decode(ChannelOf(T()), reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    return std::get<T>(message);
  } catch (const InputError& e) {
    throw InputError(path.string() + " is no message of this version: " + e.what() +
                     "; `rgbdt calibrate` does without it");
  }
}

void WriteMessage(const fs::path& path, const Message& message) {
  const Bytes bytes = Encode(message);
  WriteFileAtomically(path, std::string(bytes.begin(), bytes.end()));
}

bool HoldsViews(const fs::path& views) {
  std::error_code error;
  for (fs::directory_iterator it(views, error), end; !error && it != end; it.increment(error)) {
    if (it->path().filename().string().front() != '.') return true;
  }
  return false;
}

Session OpenEarlier(const fs::path& directory, const Rig& rig) {
  const std::string holds = (directory / "views").string() + " holds views of an earlier session";
  std::error_code ignored;
  if (!fs::exists(directory / "rig.textproto", ignored)) {
    throw InputError(holds + ", of which rig is not known (there is no rig.textproto); " + kWayOut);
  }
  if (fs::exists(directory / kEndedFile, ignored)) {
    throw InputError(holds + " that has ended (see the file 'ended'); " + kWayOut);
  }
  Session session = OpenSession(directory, LensNeed::kKnown);
  const std::vector<std::string> differences = DifferencesOf(session.rig, rig);
  if (!differences.empty()) {
    throw InputError(holds + " of another rig (" + InOneLine(differences) + "); " + kWayOut);
  }
  return session;
}

// It only saves a sweep: whatever is wrong with it, there is none.
std::optional<SessionCommand> ReadAsked(const fs::path& directory, const Rig& rig) {
  try {
    const auto age = fs::file_time_type::clock::now() - fs::last_write_time(directory / kAskedFile);
    if (age > std::chrono::seconds(kAskedIsOld) || fs::exists(directory / kEndedFile)) return {};
    if (!DifferencesOf(ReadRig(directory / "rig.textproto"), rig).empty()) return {};
    const auto asked = ReadMessage<SessionCommand>(directory / kAskedFile);
    const bool of_view = asked.verb == SessionVerb::kNextPose ||
                         asked.verb == SessionVerb::kSweep || asked.verb == SessionVerb::kCapture;
    return of_view ? std::optional(asked) : std::nullopt;
  } catch (const std::exception&) {
    return std::nullopt;
  }
}

bool IsNumber(const std::string& name) {
  return !name.empty() && name.size() < 9 &&
         std::all_of(name.begin(), name.end(), [](char c) { return c >= '0' && c <= '9'; });
}

// Follows the names that a script gives to its views.
class Names {
 public:
  void Take(SessionStep::Kind kind) {
    const bool begins = kind == SessionStep::Kind::kNextPose ||
                        (kind == SessionStep::Kind::kSweep && (number_ == 0 || taken_));
    if (begins) ++number_;
    taken_ = kind == SessionStep::Kind::kCapture || (taken_ && !begins);
  }
  int number() const { return number_; }

 private:
  int number_ = 0;
  bool taken_ = false;
};

SessionVerb VerbOf(SessionStep::Kind kind) {
  switch (kind) {
    case SessionStep::Kind::kNextPose:
      return SessionVerb::kNextPose;
    case SessionStep::Kind::kSweep:
      return SessionVerb::kSweep;
    case SessionStep::Kind::kCapture:
      return SessionVerb::kCapture;
    default:
      return SessionVerb::kReset;
  }
}

// Of the steps of the next view.
void FindAsked(const SessionScript& script, const SessionCommand& asked, ResumePoint* point) {
  Names names;
  for (std::size_t i = 0; i < script.steps.size(); ++i) {
    const SessionStep& step = script.steps[i];
    names.Take(step.kind);
    if (i < point->step) continue;
    const bool same = VerbOf(step.kind) == asked.verb && ViewName(names.number()) == asked.view;
    const bool capture = step.kind == SessionStep::Kind::kCapture;
    if (same && (!capture ||
                 (step.heldout == asked.heldout && step.picked_cameras == asked.picked_cameras))) {
      point->step = i;
      point->view_number = names.number();
      point->asked = true;
      return;
    }
    if (capture) return;
  }
}

}  // namespace

std::string ViewName(int number) {
  char name[16];
  std::snprintf(name, sizeof(name), "%04d", number);
  return name;
}

int EarlierViews::NewestNumber() const {
  int newest = 0;
  const auto look = [&](const std::string& name) {
    if (IsNumber(name)) newest = std::max(newest, std::stoi(name));
  };
  for (const auto& [name, detection] : detected) look(name);
  for (const std::string& name : undetected) look(name);
  return newest;
}

Utime EarlierViews::NewestUtime() const {
  Utime newest = 0;
  for (const auto& [name, detection] : detected) {
    newest = std::max(newest, detection.sweep_utime);
    for (const ImageDetection& image : detection.images) newest = std::max(newest, image.utime);
  }
  return newest;
}

EarlierViews ReadEarlierViews(const fs::path& directory, const Rig& rig) {
  EarlierViews views;
  views.asked = ReadAsked(directory, rig);
  if (!HoldsViews(directory / "views")) return views;
  std::error_code ignored;
  for (const std::string& name : OpenEarlier(directory, rig).views) {
    const fs::path folder = directory / "views" / name;
    if (fs::exists(folder / kDetectionFile, ignored) &&
        fs::exists(folder / "view.textproto", ignored)) {
      views.detected[name] = ReadMessage<ViewDetection>(folder / kDetectionFile);
      if (views.detected[name].view != name) {
        throw InputError((folder / kDetectionFile).string() + " is of view \"" +
                         views.detected[name].view + "\"; the folder was renamed or copied");
      }
    } else {
      views.undetected.insert(name);
    }
  }
  if (fs::exists(directory / kLeftOutFile, ignored)) {
    views.left_out = ReadMessage<LeftOutViews>(directory / kLeftOutFile);
  }
  return views;
}

ResumePoint FindResumePoint(const SessionScript& script, const EarlierViews& views,
                            const fs::path& directory) {
  const std::string folder = (directory / "views").string();
  const auto fail = [&](const std::string& what) {
    throw InputError(folder + " holds views of an earlier session by another script: " + what +
                     "; " + kWayOut);
  };
  ResumePoint point;
  Names names;
  std::set<std::string> unexpected = views.undetected;
  for (const auto& [name, detection] : views.detected) unexpected.insert(name);
  for (std::size_t i = 0; i < script.steps.size(); ++i) {
    const SessionStep& step = script.steps[i];
    names.Take(step.kind);
    if (step.kind != SessionStep::Kind::kCapture) continue;
    const std::string name = ViewName(names.number());
    const auto found = views.detected.find(name);
    if (found == views.detected.end()) {
      if (unexpected.erase(name) != 0) point.unfinished = name;
      break;
    }
    if (found->second.heldout != step.heldout) {
      fail("view " + name + " is " + (step.heldout ? "not " : "") +
           "held out, by the script it is" + (step.heldout ? "" : " not"));
    }
    unexpected.erase(name);
    point.step = i + 1;
    point.view_number = names.number();
  }
  if (!unexpected.empty()) {
    fail("view " + *unexpected.begin() + " is there, of which the script says nothing, or before " +
         "which it takes others");
  }
  if (point.step == script.steps.size()) fail("nothing is left to do");
  if (views.asked) FindAsked(script, *views.asked, &point);
  return point;
}

ResumePoint FindResumePoint(const EarlierViews& views) {
  ResumePoint point;
  point.view_number = views.NewestNumber();
  if (!views.asked || !IsNumber(views.asked->view)) return point;
  const std::string& view = views.asked->view;
  if (views.detected.count(view) != 0 || std::stoi(view) < point.view_number) return point;
  point.view_number = std::stoi(view);
  point.asked = true;
  if (views.undetected.count(view) != 0) point.unfinished = view;
  return point;
}

void WriteDetection(const fs::path& directory, const ViewDetection& detection) {
  WriteMessage(OwnFolder(OwnFolder(directory, "views"), detection.view) / kDetectionFile,
               detection);
}

void WriteLeftOut(const fs::path& directory, const LeftOutViews& left_out) {
  WriteMessage(directory / kLeftOutFile, left_out);
}

void WriteAsked(const fs::path& directory, const SessionCommand& command) {
  WriteMessage(directory / kAskedFile, command);
}

void RemoveAsked(const fs::path& directory) {
  std::error_code ignored;
  fs::remove(directory / kAskedFile, ignored);
}

void WriteEnded(const fs::path& directory) {
  WriteFileAtomically(directory / kEndedFile, "saved; a session started again does not go on\n");
}

void RemoveTraces(const fs::path& directory) {
  for (const char* name : {kLeftOutFile, kEndedFile}) {
    std::error_code error;
    fs::remove(directory / name, error);
    if (error) {
      throw InputError("cannot remove " + (directory / name).string() + ": " + error.message());
    }
  }
}

}  // namespace rgbdt
