#include "services/command_line/command_line.h"

#include "tests/unit/matchers.h"

namespace rgbdt {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

int RunWith(CommandLine* line, std::vector<std::string> words, const std::function<int()>& run) {
  words.insert(words.begin(), "program");
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  const auto argc = static_cast<int>(argv.size());
  return run ? line->Run(argc, argv.data(), run) : line->Run(argc, argv.data());
}

enum class Fruit { kApple, kPear };
const std::map<std::string, Fruit> kFruits = {{"apple", Fruit::kApple}, {"pear", Fruit::kPear}};

struct Flags {
  std::string dir, out = "out/here", url;
  double speed = 2;
  std::uint64_t seed = 1;
  std::vector<std::string> cameras;
  bool png = false;
  Fruit fruit = Fruit::kApple;
};

int Parse(Flags* flags, const std::vector<std::string>& words) {
  CommandLine line("program", "Does it.");
  line.Required("DIR", &flags->dir, "a folder");
  line.Option("--out", &flags->out, "where to write");
  line.Option("--lcm-url", &flags->url, "the bus");
  line.Within("--speed", &flags->speed, 0.1, 10, "of it");
  line.Option("--seed", &flags->seed, "of everything random");
  line.Option("--camera", &flags->cameras, "may be given again");
  line.Flag("--png", &flags->png, "also draw");
  line.Choice("--fruit", &flags->fruit, kFruits, "apple or pear");
  return RunWith(&line, words, [] { return 7; });
}

TEST(CommandLine, ReadsWhatIsGivenAndKeepsTheRest) {
  Flags flags;
  EXPECT_EQ(Parse(&flags, {"here", "--speed", "0.5", "--camera", "rgb", "--camera", "thermal",
                           "--png", "--fruit", "pear", "--seed", "18446744073709551615"}),
            7);
  EXPECT_EQ(flags.dir, "here");
  EXPECT_EQ(flags.out, "out/here");
  EXPECT_EQ(flags.speed, 0.5);
  EXPECT_EQ(flags.seed, 18446744073709551615U);
  EXPECT_THAT(flags.cameras, ElementsAre("rgb", "thermal"));
  EXPECT_TRUE(flags.png);
  EXPECT_EQ(flags.fruit, Fruit::kPear);
}

TEST(CommandLine, RefusesWhatMakesNoSense) {
  Flags flags;
  for (const std::vector<std::string>& words :
       std::vector<std::vector<std::string>>{{},
                                             {"here", "there"},
                                             {"here", "--colour"},
                                             {"here", "--speed", "11"},
                                             {"here", "--speed", "fast"},
                                             {"here", "--seed", "-1"},
                                             {"here", "--fruit", "moon"}}) {
    EXPECT_NE(Parse(&flags, words), 0) << testing::PrintToString(words);
    EXPECT_NE(Parse(&flags, words), 7) << testing::PrintToString(words);
  }
}

TEST(CommandLine, HelpShowsDefaultsThatAreNotEmpty) {
  Flags flags;
  testing::internal::CaptureStdout();
  EXPECT_EQ(Parse(&flags, {"--help"}), 0);
  const std::string help = testing::internal::GetCapturedStdout();
  EXPECT_THAT(help, HasSubstr("out/here"));
  EXPECT_THAT(help, HasSubstr("--version"));
  EXPECT_THAT(help, HasSubstr("apple,pear"));
  EXPECT_THAT(help, Not(HasSubstr("--lcm-url TEXT=")));
}

TEST(CommandLine, TellsWhatIsThrown) {
  CommandLine line("program", "Does it.");
  testing::internal::CaptureStderr();
  EXPECT_EQ(RunWith(&line, {}, []() -> int { throw std::runtime_error("no such rig"); }), 1);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "program: no such rig\n");
}

TEST(CommandLine, RunsTheVerbThatIsNamed) {
  std::string dir;
  CommandLine line("program", "Does one of two.");
  line.Verb("rest", "Does nothing.", [] { return 0; });
  line.Verb("work", "Does it.", [&] { return dir == "here" ? 5 : 6; })
      ->Required("DIR", &dir, "a folder");
  EXPECT_EQ(RunWith(&line, {"work", "here"}, nullptr), 5);
  testing::internal::CaptureStderr();
  EXPECT_EQ(RunWith(&line, {"play"}, nullptr), 1);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("there is no verb \"play\""));
  EXPECT_NE(RunWith(&line, {}, nullptr), 0);
}

TEST(CommandLine, AVectorWithoutDashesTakesAllWords) {
  CommandLine line("example", "Does nothing.");
  std::vector<std::string> files;
  std::string rig;
  line.Required("FILE", &files, "one or more");
  line.Option("--rig", &rig, "a rig");
  EXPECT_EQ(RunWith(&line, {"a", "b", "--rig", "r", "c"}, [] { return 0; }), 0);
  EXPECT_EQ(files, (std::vector<std::string>{"a", "b", "c"}));
  EXPECT_EQ(rig, "r");
}

TEST(CommandLine, KeepsTheWordsOfAnotherCommand) {
  bool run = false;
  std::vector<std::string> rest;
  CommandLine line("program", "Runs another.");
  line.Flag("--run", &run, "another command");
  line.Rest(&rest);
  EXPECT_EQ(RunWith(&line, {"--run", "ls", "-l", "--all"}, [] { return 0; }), 0);
  EXPECT_TRUE(run);
  EXPECT_THAT(rest, ElementsAre("ls", "-l", "--all"));
}

}  // namespace
}  // namespace rgbdt
