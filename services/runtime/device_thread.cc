#include "services/runtime/device_thread.h"

#include <chrono>

namespace rgbdt {

DeviceThread::DeviceThread(Serve serve, std::size_t most_waiting)
    : serve_(std::move(serve)), most_waiting_(most_waiting), thread_([this] { Run(); }) {}

void DeviceThread::Run() {
  while (!stopping_) {
    try {
      serve_(*this);
      break;
    } catch (const std::exception& e) {
      Warn(e.what());
    }
    Sleep(kRetryMs * 1000);
  }
  returned_ = true;
}

bool DeviceThread::Sleep(Utime us) {
  std::unique_lock<std::mutex> lock(mutex_);
  wake_.wait_for(lock, std::chrono::microseconds(us), [this] { return stopping_.load(); });
  return !stopping_;
}

void DeviceThread::Publish(Message message) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (output_.messages.size() >= most_waiting_) {
    output_.messages.erase(output_.messages.begin());
    ++overflown_;
  }
  output_.messages.push_back(std::move(message));
}

void DeviceThread::Warn(const std::string& warning) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (output_.warnings.size() < kMaxWaiting) output_.warnings.push_back(warning);
}

DeviceOutput DeviceThread::Take() {
  DeviceOutput output;
  const std::lock_guard<std::mutex> lock(mutex_);
  std::swap(output, output_);
  if (overflown_ > 0) {
    output.warnings.push_back("the machine does not keep up: " + std::to_string(overflown_) +
                              " messages of the device were given up");
    overflown_ = 0;
  }
  return output;
}

bool DeviceThread::ended() const {
  if (!returned_) return false;
  const std::lock_guard<std::mutex> lock(mutex_);
  return output_.messages.empty() && output_.warnings.empty();
}

void DeviceThread::Stop() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

Messages DeviceNode::TakeFrom(DeviceThread* thread) const {
  DeviceOutput output = thread->Take();
  for (const std::string& warning : output.warnings) Warn(warning);
  return std::move(output.messages);
}

}  // namespace rgbdt
