#include "services/replay/wave_preview.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <exception>
#include <opencv2/core/utility.hpp>
#include <utility>

#include "calib/model/errors.h"
#include "services/messages/codec.h"
#include "services/messages/image_channel.h"
#include "services/replay/waved_log.h"

namespace rgbdt {
namespace {

using std::chrono::steady_clock;

constexpr auto kCalibrationsCome = std::chrono::milliseconds(1500);  // once a second, each
constexpr auto kLeastPause = std::chrono::seconds(1);                // between estimates
constexpr std::size_t kMostImages = 20, kMostChunks = 1000;          // that wait, of a channel
constexpr std::size_t kMostBytes = 64'000'000;                       // that wait, of a channel
constexpr std::size_t kLeastSweeps = 20, kLeastImages = 20;
constexpr double kMostGapS = 0.6;  // between images of which some were passed over

bool Tells(const WavedBoard& board) {
  return board.sweeps.size() >= kLeastSweeps &&
         std::any_of(board.cameras.begin(), board.cameras.end(), [](const WavedCamera& camera) {
           return camera.images.size() >= kLeastImages;
         });
}

}  // namespace

std::vector<WavedClock> ClocksOf(const SyncResult& result) {
  std::vector<WavedClock> clocks;
  for (const SyncedCamera& camera : result.cameras) {
    WavedClock& clock = clocks.emplace_back();
    clock.camera = camera.camera;
    clock.text = camera.why_not;
    if (!camera.why_not.empty()) continue;
    clock.time_offset_s = camera.time_offset_s;
    if (!camera.warnings.empty()) clock.text = camera.warnings.front();
  }
  return clocks;
}

void WavePreview::Queue::Add(Bytes message) {
  bytes += message.size();
  messages.push_back(std::move(message));
  while (bytes > kMostBytes || messages.size() > most_messages) Next();
}

Bytes WavePreview::Queue::Next() {
  Bytes message = std::move(messages.front());
  messages.pop_front();
  bytes -= message.size();
  return message;
}

// OpenCV's threads are the whole process': they would keep the low priority of who calls first.
WavePreview::WavePreview(std::optional<Calibration> calibration, const WavedLogOptions& options)
    : calibration_(std::move(calibration)),
      options_(options),
      threads_before_(cv::getNumThreads()) {
  cv::setNumThreads(1);
  thread_ = std::thread([this] { Run(); });
}

WavePreview::~WavePreview() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  thread_.join();
  cv::setNumThreads(threads_before_);
}

void WavePreview::TakeRig(const Rig& rig) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (rig_) return;
  rig_ = rig;
  waiting_["CLOUD"].most_messages = kMostChunks;
  for (const CameraSpec& camera : rig.cameras) {
    waiting_[ImageChannel(camera.name)].most_messages = kMostImages;
  }
  wake_.notify_all();
}

void WavePreview::TakeCalibration(const CalibrationMessage& calibration) {
  const std::lock_guard<std::mutex> lock(mutex_);
  cameras_[calibration.calibration.camera] = calibration;
}

void WavePreview::Take(const std::string& channel, const std::uint8_t* data, std::size_t size) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto queue = waiting_.find(channel);
  if (queue == waiting_.end()) return;
  queue->second.Add(Bytes(data, data + size));
  wake_.notify_all();
}

std::vector<WavedClock> WavePreview::Clocks() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return clocks_;
}

std::string WavePreview::WhyNot() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return why_not_;
}

bool WavePreview::Stopping() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return stopping_;
}

// Once the rig is known, and all the calibrations that there are.
std::optional<WaveReader> WavePreview::Begin() {
  std::unique_lock<std::mutex> lock(mutex_);
  wake_.wait(lock, [this] { return stopping_ || rig_; });
  if (!calibration_) wake_.wait_for(lock, kCalibrationsCome, [this] { return stopping_; });
  if (stopping_) return std::nullopt;
  try {
    return WaveReader(*rig_, calibration_ ? calibration_ : CalibrationOf(cameras_), options_);
  } catch (const InputError& error) {
    why_not_ = error.what();
    return std::nullopt;
  }
}

// All of the clouds, and one image of each camera, so that those for which there is no time are
// spread over the wave. Empty: it is to stop.
WavePreview::Batch WavePreview::Wait() {
  Batch batch;
  std::unique_lock<std::mutex> lock(mutex_);
  wake_.wait(lock, [this] {
    return stopping_ || std::any_of(waiting_.begin(), waiting_.end(), [](const auto& queue) {
             return !queue.second.messages.empty();
           });
  });
  if (stopping_) return batch;
  for (auto& [channel, queue] : waiting_) {
    while (!queue.messages.empty()) {
      batch.emplace_back(channel, queue.Next());
      if (IsImageChannel(channel)) break;
    }
  }
  return batch;
}

void WavePreview::TakeAll(const Batch& batch, WaveReader* reader) const {
  for (const auto& [channel, bytes] : batch) {
    if (Stopping()) return;
    try {
      reader->Take(Decode(channel, bytes.data(), bytes.size()));
    } catch (const InputError&) {  // counted as the recording is read
    }
  }
}

void WavePreview::Solve(const WavedBoard& board) {
  SyncOptions options;
  options.most_gap_s = kMostGapS;
  std::vector<WavedClock> clocks;
  try {
    clocks = ClocksOf(Synchronise(board, options));
  } catch (const InputError&) {  // so far it makes no sense
    return;
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  clocks_ = std::move(clocks);
}

void WavePreview::Watch() {
  std::optional<WaveReader> reader = Begin();
  steady_clock::time_point due = steady_clock::now();
  while (reader && !reader->Full()) {
    TakeAll(Wait(), &*reader);
    if (Stopping()) return;
    const auto start = steady_clock::now();
    if (start < due || !Tells(reader->board())) continue;
    Solve(reader->board());
    const auto end = steady_clock::now();
    due = end + std::max<steady_clock::duration>(kLeastPause, end - start);
  }
}

void WavePreview::Run() {
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), 19);  // of this thread, and of its helpers
  try {
    Watch();
  } catch (const std::exception&) {  // the recording goes on; reading it says what is wrong
  }
  const std::lock_guard<std::mutex> lock(mutex_);
  waiting_.clear();  // and nothing more is kept
}

}  // namespace rgbdt
