#include "services/bus/log.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "calib/model/descriptor.h"
#include "calib/model/errors.h"
#include "services/bus/log_writer.h"
#include "tests/unit/messages/random_messages.h"

namespace rgbdt {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr std::size_t kHeaderBytes = 28;

class LogTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(directory_);
    LogWriter writer(path_);
    for (int i = 0; i < 20; ++i) {
      events_.push_back({i, 1000 + i, "CHANNEL" + std::to_string(i),
                         Bytes(static_cast<std::size_t>(37 * i), static_cast<std::uint8_t>(i))});
      writer.Write(events_.back().channel, events_.back().bytes, events_.back().receive_utime);
    }
    writer.Close();
  }
  void TearDown() override { std::filesystem::remove_all(directory_); }

  Bytes FileBytes() const {
    std::ifstream file(path_, std::ios::binary);
    return Bytes(std::istreambuf_iterator<char>(file), {});
  }
  void WriteFile(const Bytes& bytes) const {
    std::ofstream(path_, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  }
  std::size_t EventStart(int event) const {
    std::size_t start = 0;
    for (int i = 0; i < event; ++i) {
      start += kHeaderBytes + events_[static_cast<std::size_t>(i)].channel.size() +
               events_[static_cast<std::size_t>(i)].bytes.size();
    }
    return start;
  }
  /// Numbers of the events that can be read; each as it was written.
  std::vector<int> Numbers(std::int64_t* unreadable) const {
    LogReader reader(path_);
    std::vector<int> numbers;
    while (const auto event = reader.Next()) {
      const auto number = static_cast<std::size_t>(event->number);
      numbers.push_back(static_cast<int>(number));
      EXPECT_LT(number, events_.size());
      if (number >= events_.size()) continue;
      EXPECT_EQ(event->channel, events_[number].channel);
      EXPECT_EQ(event->bytes, events_[number].bytes);
      EXPECT_EQ(event->receive_utime, events_[number].receive_utime);
    }
    EXPECT_EQ(reader.position(), reader.size());
    *unreadable = reader.unreadable_bytes();
    return numbers;
  }
  static std::vector<int> AllBut(int missing) {
    std::vector<int> numbers;
    for (int i = 0; i < 20; ++i) {
      if (i != missing) numbers.push_back(i);
    }
    return numbers;
  }

  std::filesystem::path directory_ =
      std::filesystem::temp_directory_path() / ("rgbdt_log_test_" + std::to_string(getpid()));
  std::string path_ = directory_ / "log";
  std::vector<LogEvent> events_;
  std::int64_t unreadable_ = 0;
};

TEST_F(LogTest, ReadsWhatWasWritten) {
  EXPECT_EQ(Numbers(&unreadable_), AllBut(-1));
  EXPECT_EQ(unreadable_, 0);
}

TEST_F(LogTest, EveryTruncationGivesAllWholeEvents) {
  const Bytes whole = FileBytes();
  for (std::size_t size = EventStart(17); size < whole.size(); ++size) {
    WriteFile(Bytes(whole.data(), whole.data() + size));
    int expected = 17;
    while (EventStart(expected + 1) <= size) ++expected;
    EXPECT_EQ(static_cast<int>(Numbers(&unreadable_).size()), expected);
    EXPECT_EQ(unreadable_, static_cast<std::int64_t>(size - EventStart(expected)));
  }
}

TEST_F(LogTest, RubbishInBetween) {
  Bytes bytes = FileBytes();
  const Bytes rubbish(1000, 0xed);
  bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(EventStart(5)), rubbish.begin(),
               rubbish.end());
  WriteFile(bytes);
  EXPECT_EQ(Numbers(&unreadable_), AllBut(-1));
  EXPECT_EQ(unreadable_, 1000);
}

// Lengths forged in one header: too short, too long, beyond the end, negative.
TEST_F(LogTest, ForgedLengthsLoseOneEventOnly) {
  const Bytes whole = FileBytes();
  const std::uint32_t forged[] = {0, 5, 1000, 0x0fffffff, 0x7fffffff, 0xffffffff};
  for (const std::uint32_t length : forged) {
    for (const std::size_t field : {20U, 24U}) {
      Bytes bytes = whole;
      for (std::size_t i = 0; i < 4; ++i) {
        bytes[EventStart(6) + field + i] = static_cast<std::uint8_t>(length >> (24 - 8 * i));
      }
      WriteFile(bytes);
      LogReader reader(path_);
      int good = 0;
      while (const auto event = reader.Next()) {
        good += event->channel == "CHANNEL" + std::to_string(event->number) &&
                event->bytes == events_[static_cast<std::size_t>(event->number)].bytes;
      }
      EXPECT_EQ(good, 19) << length << " at " << field;
    }
  }
}

TEST_F(LogTest, RandomBytesFlippedNeverHarm) {
  const Bytes whole = FileBytes();
  testing::RandomMessages random(3);
  for (int round = 0; round < 300; ++round) {
    Bytes bytes = whole;
    for (int i = 0; i < 20; ++i) {
      bytes[static_cast<std::size_t>(random.Int(0, static_cast<int>(bytes.size()) - 1))] =
          static_cast<std::uint8_t>(random.Int(0, 255));
    }
    WriteFile(bytes);
    LogReader reader(path_);
    while (reader.Next()) {
    }
    EXPECT_EQ(reader.position(), reader.size());
  }
}

TEST_F(LogTest, NothingIsWrittenThroughALinkNorWaitedFor) {
  const Bytes before = FileBytes();
  const std::filesystem::path link = directory_ / "link", pipe = directory_ / "pipe";
  std::filesystem::create_symlink(path_, link);
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  for (const std::filesystem::path& path : {link, pipe}) {
    LogWriter writer(path);
    writer.Write("A", Bytes{1}, 5);
    writer.Close();
    EXPECT_TRUE(std::filesystem::is_regular_file(std::filesystem::symlink_status(path)));
    EXPECT_EQ(LogReader(path).Next()->bytes, Bytes{1});
  }
  EXPECT_EQ(FileBytes(), before);
  EXPECT_THROW(LogWriter{directory_.string()}, InputError);
  EXPECT_TRUE(std::filesystem::is_directory(directory_));
}

TEST_F(LogTest, OneThatIsNotClosedLeavesWhatWasThere) {
  const Bytes before = FileBytes();
  {
    LogWriter writer(path_);
    writer.Write("A", Bytes{1}, 5);
    EXPECT_EQ(FileBytes(), before);
    EXPECT_TRUE(std::filesystem::exists(std::string(path_) + ".part"));
  }
  EXPECT_EQ(FileBytes(), before);
  EXPECT_FALSE(std::filesystem::exists(std::string(path_) + ".part"));
}

TEST_F(LogTest, ADeviceStays) {
  const Descriptor terminal(posix_openpt(O_RDWR | O_NOCTTY));
  ASSERT_TRUE(terminal);
  const std::string device = ptsname(terminal.get());
  EXPECT_THAT([&] { LogWriter{device}; },
              ThrowsMessage<InputError>(HasSubstr(device + " is a device")));
  EXPECT_TRUE(std::filesystem::is_character_file(device));
}

TEST_F(LogTest, WhatIsNoLogIsSaid) {
  EXPECT_THROW(LogReader(path_ + "2"), InputError);
  EXPECT_THROW(LogReader(directory_.string()), InputError);
  const std::string pipe = (directory_ / "pipe").string();
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_THROW(LogReader{pipe}, InputError) << "nobody writes to it";
  WriteFile(Bytes(5000, 'x'));
  EXPECT_THROW(LogReader{path_}, InputError);
  WriteFile({});
  EXPECT_FALSE(LogReader(path_).Next());
}

}  // namespace
}  // namespace rgbdt
