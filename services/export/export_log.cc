#include "services/export/export_log.h"

#include <algorithm>
#include <set>
#include <utility>
#include <variant>

#include "calib/files/atomic_file.h"
#include "calib/files/schema/rig_file.h"
#include "calib/model/errors.h"
#include "calib/model/printable.h"
#include "calib/model/version.h"
#include "services/bags/mcap_writer.h"
#include "services/bus/log.h"
#include "services/messages/codec.h"
#include "services/messages/image_channel.h"

namespace rgbdt {
namespace {

bool IsExported(const std::string& channel) {
  static const std::set<std::string> channels = {"CLOUD",       "RGBDT_CLOUD",   "RGBDT_SWEEP",
                                                 "CALIBRATION", "POSE",          "RIG",
                                                 "STATUS",      "SESSION_EVENT", "MOUNT_CHECK"};
  return channels.count(channel) != 0 || IsImageChannel(channel);
}

Message DecodeEvent(const LogEvent& event) {
  return Decode(event.channel, event.bytes.data(), event.bytes.size());
}

constexpr std::size_t kMostLeftOut = 100;  // channels by name: a log may be a stranger's

// What must be known before the first message is written.
struct LogSurvey {
  Utime first = 0;         // sensor time; 0: there is none
  std::string lidar_name;  // of the first rig; empty: there is none
  bool fused_sweeps = false;
  std::map<std::string, std::int64_t> left_out;
};

LogSurvey SurveyLog(const std::string& path, const std::function<void(double)>& progress) {
  LogReader log(path);
  LogSurvey survey;
  while (const auto event = log.Next()) {
    if (progress) progress(0.5 * log.position() / static_cast<double>(log.size()));
    if (!IsExported(event->channel)) {
      const bool named =
          survey.left_out.size() < kMostLeftOut || survey.left_out.count(event->channel) != 0;
      ++survey.left_out[named ? event->channel : "other channels"];
      continue;
    }
    survey.fused_sweeps |= event->channel == "RGBDT_SWEEP";
    const bool rig_wanted = survey.lidar_name.empty() && event->channel == "RIG";
    if (survey.first != 0 && !rig_wanted) continue;
    try {
      const Message message = DecodeEvent(*event);
      if (survey.first == 0) survey.first = UtimeOf(message);
      if (rig_wanted) {
        survey.lidar_name =
            ParseRig(std::get<RigText>(message).text, "RIG", LensNeed::kMayBeUnknown).lidar.name;
      }
    } catch (const std::exception&) {  // counted where it is to be written
    }
  }
  return survey;
}

// The disk fails: no matter of the message that was to be written.
struct WriteError : InputError {
  using InputError::InputError;
};

void WriteTo(AtomicFile* file, std::string_view bytes) {
  try {
    file->Write(bytes);
  } catch (const InputError& error) {
    throw WriteError(error.what());
  }
}

// Topics of an MCAP, made as their first message comes.
class Topics {
 public:
  Topics(AtomicFile* file, ExportedLog* out)
      : out_(out),
        writer_([file](std::string_view bytes) { WriteTo(file, bytes); },
                std::string("rgbdt ") + Version()) {}

  void Put(const FoxgloveMessage& message) {
    ExportedLog::Topic& of_topic = out_->topics[message.topic];
    if (of_topic.schema.empty()) {
      of_topic.schema = message.schema->full_name();
      channels_[message.topic] =
          writer_.AddChannel(message.topic, SchemaOf(*message.schema), "protobuf");
    }
    writer_.Write(channels_.at(message.topic), message.log, message.sent, message.serialize());
    ++of_topic.messages;
  }
  void Finish() { writer_.Finish(); }

 private:
  std::uint16_t SchemaOf(const google::protobuf::Descriptor& type) {
    const auto found = schemas_.find(type.full_name());
    if (found != schemas_.end()) return found->second;
    const std::uint16_t id = writer_.AddSchema(type.full_name(), "protobuf", DescribeSchema(type));
    schemas_[type.full_name()] = id;
    return id;
  }

  ExportedLog* out_;
  McapWriter writer_;
  std::map<std::string, std::uint16_t> schemas_, channels_;
};

// Whether a name would be taken by who reads it.
void CheckFrames(const FoxgloveFrames& frames) {
  std::set<std::string> names;
  const auto check = [&](const std::string& name) {
    const bool odd = name.empty() || std::any_of(name.begin(), name.end(), [](unsigned char c) {
                       return c <= ' ' || c >= 0x7f;
                     });
    if (odd) throw InputError("\"" + name + "\" is no name of a frame; expected no blanks");
    if (!names.insert(name).second) {
      throw InputError("the frame \"" + name + "\" twice; give each camera and the LIDAR its own");
    }
  };
  if (!frames.lidar.empty()) check(frames.lidar);
  for (const auto& [camera, frame] : frames.cameras) check(frame);
}

FoxgloveStream::Options StreamOptions(const LogSurvey& survey, const FoxgloveFrames& frames) {
  FoxgloveStream::Options options;
  options.frames = frames;
  if (!survey.lidar_name.empty()) options.lidar = survey.lidar_name;
  options.start = survey.first;
  options.fused_sweeps = survey.fused_sweeps;
  return options;
}

}  // namespace

ExportedLog ExportLog(const std::string& log_path, const std::filesystem::path& out,
                      const FoxgloveFrames& frames, const std::function<void(double)>& progress) {
  CheckFrames(frames);
  const LogSurvey survey = SurveyLog(log_path, progress);
  LogReader log(log_path);
  ExportedLog exported;
  exported.left_out = survey.left_out;
  AtomicFile file(out);
  Topics topics(&file, &exported);
  FoxgloveStream stream(StreamOptions(survey, frames),
                        [&](const FoxgloveMessage& message) { topics.Put(message); });
  while (const auto event = log.Next()) {
    if (progress) progress(0.5 + 0.5 * log.position() / static_cast<double>(log.size()));
    if (!IsExported(event->channel)) continue;
    try {
      const Message message = DecodeEvent(*event);
      const bool is_image = std::holds_alternative<Image>(message);
      stream.Take(message,
                  is_image ? ImageFileOf(event->bytes.data(), event->bytes.size()) : Bytes());
    } catch (const WriteError&) {
      throw;
    } catch (const std::exception& error) {
      ++exported.dropped;
      exported.last_problem = PrintableText(event->channel) + ": " + error.what();
    }
  }
  stream.Finish();
  exported.torn_sweeps = stream.torn_sweeps();
  exported.unreadable_bytes = log.unreadable_bytes();
  if (exported.topics.empty()) {
    throw InputError(log_path + ": holds nothing to export" +
                     (exported.last_problem.empty() ? "" : "; " + exported.last_problem));
  }
  topics.Finish();
  file.Commit();
  return exported;
}

}  // namespace rgbdt
