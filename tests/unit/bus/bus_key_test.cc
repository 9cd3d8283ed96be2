#include "services/bus/bus_key.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include <fstream>

#include "calib/model/errors.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class BusKeyTest : public ::testing::Test {
 protected:
  BusKeyTest() {
    std::string name = (fs::temp_directory_path() / "rgbdt-key-XXXXXX").string();
    folder_ = mkdtemp(name.data());
    file_ = folder_ / "rig.key";
  }
  ~BusKeyTest() override { fs::remove_all(folder_); }

  std::string WhyNot() const {
    try {
      ReadBusKey(file_);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  }
  void Write(const std::string& text, mode_t mode = 0600) const {
    std::ofstream(file_, std::ios::trunc) << text;
    chmod(file_.c_str(), mode);
  }

  fs::path folder_, file_;
};

TEST_F(BusKeyTest, IsReadAsItWasWritten) {
  WriteNewBusKey(file_);
  struct stat status {};
  ASSERT_EQ(stat(file_.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0600U);
  EXPECT_EQ(fs::file_size(file_), 65U);
  const BusKey key = ReadBusKey(file_);
  EXPECT_NE(key.bytes, BusKey().bytes);
  EXPECT_EQ(ReadBusKey(file_).bytes, key.bytes);
  fs::rename(file_, folder_ / "first");
  WriteNewBusKey(file_);
  EXPECT_NE(ReadBusKey(file_).bytes, key.bytes) << "each is drawn anew";
}

TEST_F(BusKeyTest, NothingIsWrittenOver) {
  Write("something");
  EXPECT_THROW(WriteNewBusKey(file_), InputError);
  EXPECT_EQ(fs::file_size(file_), 9U);
  fs::remove(file_);
  fs::create_symlink(folder_ / "elsewhere", file_);
  EXPECT_THROW(WriteNewBusKey(file_), InputError) << "nor written through a link";
  EXPECT_FALSE(fs::exists(folder_ / "elsewhere"));
}

TEST_F(BusKeyTest, AKeyThatOthersMayReadIsRefused) {
  const std::string key(64, 'a');
  for (const mode_t mode : {0644, 0604, 0660, 0666}) {
    Write(key, mode);
    EXPECT_THAT(WhyNot(), HasSubstr("chmod 600 " + file_.string())) << mode;
  }
  for (const mode_t mode : {0400, 0600, 0440, 0640}) {
    Write(key, mode);
    EXPECT_EQ(WhyNot(), "") << mode;
  }
}

TEST_F(BusKeyTest, WhatIsNoKeyIsRefused) {
  for (const std::string& text :
       {std::string(), std::string("\n"), std::string(63, 'a'), std::string(65, 'a'),
        std::string(66, 'a'), std::string(64, 'g'), std::string(10'000, 'a'),
        std::string(32, 'a') + " " + std::string(31, 'a'), std::string(64, '\0')}) {
    Write(text);
    EXPECT_THAT(WhyNot(), HasSubstr("64 hexadecimal digits")) << text.size();
  }
  fs::remove(file_);
  EXPECT_THAT(WhyNot(), HasSubstr("No such file"));
  ASSERT_EQ(mkfifo(file_.c_str(), 0600), 0);
  EXPECT_THAT(WhyNot(), HasSubstr("no regular file"));
  fs::remove(file_);
  fs::create_directory(file_);
  EXPECT_NE(WhyNot(), "");
}

}  // namespace
}  // namespace rgbdt
