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
      Complain(e.what());
    }
    Sleep(kRetryMs);
  }
  returned_ = true;
}

bool DeviceThread::Sleep(int ms) {
  std::unique_lock<std::mutex> lock(mutex_);
  wake_.wait_for(lock, std::chrono::milliseconds(ms), [this] { return stopping_.load(); });
  return !stopping_;
}

void DeviceThread::Say(Message message) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (news_.messages.size() >= most_waiting_) {
    news_.messages.erase(news_.messages.begin());
    ++overflown_;
  }
  news_.messages.push_back(std::move(message));
}

void DeviceThread::Complain(const std::string& problem) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (news_.problems.size() < kMaxWaiting) news_.problems.push_back(problem);
}

DeviceNews DeviceThread::TakeNews() {
  DeviceNews news;
  const std::lock_guard<std::mutex> lock(mutex_);
  std::swap(news, news_);
  if (overflown_ > 0) {
    news.problems.push_back("the machine does not keep up: " + std::to_string(overflown_) +
                            " messages of the device were given up");
    overflown_ = 0;
  }
  return news;
}

bool DeviceThread::ended() const {
  if (!returned_) return false;
  const std::lock_guard<std::mutex> lock(mutex_);
  return news_.messages.empty() && news_.problems.empty();
}

void DeviceThread::Stop() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

}  // namespace rgbdt
