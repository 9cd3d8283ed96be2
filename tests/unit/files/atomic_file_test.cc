#include "calib/files/atomic_file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <fstream>

#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

std::size_t FilesIn(const fs::path& folder) {
  return static_cast<std::size_t>(
      std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

TEST(AtomicFile, GivesBackEveryByteAndMakesFolders) {
  const test::TempDir dir;
  std::string bytes;
  for (int i = 0; i < 200'000; ++i) bytes += static_cast<char>(i * 7);
  WriteFileAtomically(dir / "a/b/c.bin", bytes);
  EXPECT_EQ(ReadWholeFile(dir / "a/b/c.bin"), bytes);
  WriteFileAtomically(dir / "a/b/c.bin", "");
  EXPECT_EQ(ReadWholeFile(dir / "a/b/c.bin"), "");
  EXPECT_EQ(FilesIn(dir / "a/b"), 1u) << "a temporary file was left";
}

TEST(AtomicFile, OtherPeopleMayReadWhatIsWritten) {
  const test::TempDir dir;
  const mode_t before = umask(022);
  WriteFileAtomically(dir / "x", "x");
  umask(before);
  EXPECT_EQ(fs::status(dir / "x").permissions(), static_cast<fs::perms>(0644));
}

TEST(AtomicFile, AFailingWriteLeavesTheOldFileAndNoOther) {
  const test::TempDir dir;
  // A folder of the file's name that is not empty: the rename at the end must fail.
  WriteFileAtomically(dir / "target/old", "old");
  const std::string error = test::ErrorOf([&] { WriteFileAtomically(dir / "target", "new"); });
  EXPECT_THAT(error, HasSubstr((dir / "target").string()));
  EXPECT_EQ(ReadWholeFile(dir / "target/old"), "old");
  EXPECT_EQ(FilesIn(dir.path()), 1u) << "a temporary file was left";
}

// A process that was killed had the same number, as the only one of a container has.
TEST(AtomicFile, WhatAKilledProcessLeftIsNotInTheWay) {
  const test::TempDir dir;
  const std::string begin = ".tmp-" + std::to_string(getpid()) + "-";
  int last = 0;
  {
    const AtomicFile one(dir / "one");
    const std::string name = fs::directory_iterator(dir.path())->path().filename().string();
    ASSERT_EQ(name.substr(0, begin.size()), begin);
    last = std::stoi(name.substr(begin.size()));
  }
  for (const int ahead : {1, 2}) std::ofstream(dir / (begin + std::to_string(last + ahead))) << "x";
  WriteFileAtomically(dir / "file", "new");
  EXPECT_EQ(ReadWholeFile(dir / "file"), "new");
  EXPECT_EQ(FilesIn(dir.path()), 3u) << "those of others stay";
}

TEST(AtomicFile, AReaderOfTheOldFileKeepsIt) {
  const test::TempDir dir;
  WriteFileAtomically(dir / "file", "old");
  std::ifstream reader(dir / "file");
  WriteFileAtomically(dir / "file", "new!");
  std::string text;
  reader >> text;
  EXPECT_EQ(text, "old");
  EXPECT_EQ(ReadWholeFile(dir / "file"), "new!");
}

TEST(AtomicFile, PieceByPieceIsThereOnceItIsWhole) {
  const test::TempDir dir;
  WriteFileAtomically(dir / "file", "old");
  {
    AtomicFile file(dir / "file");
    file.Write("one ");
    file.Write("two");
    EXPECT_EQ(ReadWholeFile(dir / "file"), "old");
    file.Commit();
  }
  EXPECT_EQ(ReadWholeFile(dir / "file"), "one two");
  {
    AtomicFile file(dir / "file");
    file.Write("a part");
  }
  EXPECT_EQ(ReadWholeFile(dir / "file"), "one two");
  EXPECT_EQ(FilesIn(dir.path()), 1u) << "a temporary file was left";
}

TEST(AtomicFile, ErrorsNameThePathAndTheReason) {
  const test::TempDir dir;
  const std::string missing = test::ErrorOf([&] { ReadWholeFile(dir / "none.pcd"); });
  EXPECT_THAT(missing, HasSubstr((dir / "none.pcd").string()));
  EXPECT_THAT(missing, HasSubstr("No such file"));
  EXPECT_THAT(test::ErrorOf([&] { ReadWholeFile(dir.path()); }), HasSubstr("directory"));
}

TEST(ReadWholeFile, RefusesWhatIsTooLargeBeforeItIsRead) {
  const test::TempDir dir;
  WriteFileAtomically(dir / "sparse", "head");
  fs::resize_file(dir / "sparse", std::uintmax_t{10} << 30);  // holes: takes no room on the disk
  const std::string error = test::ErrorOf([&] { ReadWholeFile(dir / "sparse", kMostPointsBytes); });
  EXPECT_THAT(error, HasSubstr((dir / "sparse").string()));
  EXPECT_THAT(error, HasSubstr("10737418240 bytes; expected at most 4294967296"));
  EXPECT_EQ(ReadFileHead(dir / "sparse", 4), "head");
}

TEST(ReadWholeFile, DoesNotWaitForAPipeThatNobodyWritesTo) {
  const test::TempDir dir;
  ASSERT_EQ(mkfifo((dir / "pipe").c_str(), 0600), 0);
  for (const fs::path& path : {dir / "pipe", fs::path("/dev/zero")}) {
    EXPECT_THAT(test::ErrorOf([&] { ReadWholeFile(path); }),
                AllOf(HasSubstr(path.string()), HasSubstr("expected a file")));
  }
}

TEST(ReadWholeFile, ReadsWhatTheKernelSaysIsEmpty) {
  EXPECT_THAT(ReadWholeFile("/proc/self/status"), HasSubstr("Pid:"));
}

}  // namespace
}  // namespace rgbdt
