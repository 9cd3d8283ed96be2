#include "services/command_line/command_line.h"

#include <algorithm>
#include <sstream>

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
  std::string method = "auto";
  std::vector<std::string> dishes = {"pie", "soup"};
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
  line.Choice("--fruit", &flags->fruit, kFruits, "what to eat");
  line.Choice("--method", &flags->method, {"auto", "10", "9"}, "");
  line.Option("--dish", &flags->dishes, "what is cooked");
  return RunWith(&line, words, [] { return 7; });
}

std::string Help() {
  Flags flags;
  testing::internal::CaptureStdout();
  EXPECT_EQ(Parse(&flags, {"--help"}), 0);
  return testing::internal::GetCapturedStdout();
}

TEST(CommandLine, ReadsWhatIsGivenAndKeepsTheRest) {
  Flags flags;
  EXPECT_EQ(
      Parse(&flags, {"here", "--speed", "0.5", "--camera", "rgb", "--camera", "thermal", "--png",
                     "--fruit", "pear", "--seed", "18446744073709551615", "--method", "10"}),
      7);
  EXPECT_EQ(flags.dir, "here");
  EXPECT_EQ(flags.out, "out/here");
  EXPECT_EQ(flags.speed, 0.5);
  EXPECT_EQ(flags.seed, 18446744073709551615U);
  EXPECT_THAT(flags.cameras, ElementsAre("rgb", "thermal"));
  EXPECT_TRUE(flags.png);
  EXPECT_EQ(flags.fruit, Fruit::kPear);
  EXPECT_EQ(flags.method, "10");
}

// What stderr says, in one line, of words that make no sense.
std::string Refusal(const std::vector<std::string>& words) {
  Flags flags;
  testing::internal::CaptureStderr();
  EXPECT_EQ(Parse(&flags, words), 2) << testing::PrintToString(words);
  std::string text = testing::internal::GetCapturedStderr();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
  EXPECT_THAT(text, testing::StartsWith("program: "));
  EXPECT_THAT(text, testing::EndsWith("; see program --help\n"));
  return text;
}

TEST(CommandLine, RefusesWhatMakesNoSenseInALine) {
  EXPECT_THAT(Refusal({}), HasSubstr("DIR"));
  EXPECT_THAT(Refusal({"here", "there"}), HasSubstr("there"));
  EXPECT_THAT(Refusal({"here", "--colour"}), HasSubstr("--colour"));
  EXPECT_THAT(Refusal({"here", "--speed", "11"}), HasSubstr("--speed: 11 is not within 0.1 to 10"));
  EXPECT_THAT(Refusal({"here", "--speed", "fast"}), HasSubstr("--speed: fast is not within"));
  EXPECT_THAT(Refusal({"here", "--seed", "-1"}), HasSubstr("--seed: -1 is less than 0"));
  EXPECT_THAT(Refusal({"here", "--fruit", "moon"}),
              HasSubstr("--fruit: \"moon\" is none of apple, pear"));
  EXPECT_THAT(Refusal({"here", "--method", "magic"}),
              HasSubstr("--method: \"magic\" is none of 9, 10, auto"));
}

TEST(CommandLine, HelpBreaksLongLinesWhereAWordEnds) {
  std::string dir;
  CommandLine line("program", "Does it.");
  std::string words = "begin";
  for (int i = 0; i < 40; ++i) words += " word" + std::to_string(i);
  line.Option("--long", &dir, words + "\nnext");
  line.Option("--one", &dir, std::string(200, 'x'));
  testing::internal::CaptureStdout();
  RunWith(&line, {"--help"}, {});
  const std::string help = testing::internal::GetCapturedStdout();
  std::istringstream lines(help);
  std::string all;
  for (std::string text; std::getline(lines, text);) {
    if (text.find("xxx") == std::string::npos) {
      EXPECT_LE(text.size(), 125U) << text;
    }
    all += text.substr(std::min(text.find_first_not_of(' '), text.size())) + " ";
  }
  EXPECT_THAT(all, HasSubstr(words + " next")) << "not a word is lost";
  EXPECT_THAT(help, HasSubstr(std::string(200, 'x'))) << "a word is not broken";
}

TEST(CommandLine, HelpShowsDefaultsThatAreNotEmpty) {
  const std::string help = Help();
  EXPECT_THAT(help, HasSubstr("out/here"));
  EXPECT_THAT(help, HasSubstr("--version"));
  EXPECT_THAT(help, HasSubstr("--seed UINT=1  "));
  EXPECT_THAT(help, HasSubstr("--dish TEXT=pie soup ...  "));
  EXPECT_THAT(help, HasSubstr("of it, 0.1 to 10\n"));
  EXPECT_THAT(help, Not(HasSubstr("--lcm-url TEXT=")));
}

TEST(CommandLine, HelpHasTheNamesOfAChoiceAndNothingElseOfIt) {
  const std::string help = Help();
  EXPECT_THAT(help, HasSubstr("--fruit NAME=apple          apple, pear: what to eat\n"));
  EXPECT_THAT(help, HasSubstr("--method NAME=auto          9, 10, auto\n"));
  EXPECT_THAT(help, Not(testing::ContainsRegex("[{}]|->|NONNEG|FLOAT in")));
}

TEST(CommandLine, HelpSaysHowItEnds) {
  EXPECT_THAT(Help(),
              testing::ContainsRegex("\nExit codes:\n  0 +done\n  1 +failed.*\n  2 +wrong"));
  CommandLine line("program", "Does it.");
  line.Ends(ExitCode::kFailed, "failed, or\nrotten");
  testing::internal::CaptureStdout();
  RunWith(&line, {"--help"}, [] { return 7; });
  EXPECT_THAT(testing::internal::GetCapturedStdout(),
              testing::ContainsRegex("\n  1 {27}failed, or\n {30}rotten\n  2 +wrong"));
}

TEST(CommandLine, TheVersionMayHaveACommitAndNothingElse) {
  Flags flags;
  testing::internal::CaptureStdout();
  EXPECT_EQ(Parse(&flags, {"--version"}), 0);
  EXPECT_THAT(testing::internal::GetCapturedStdout(),
              testing::MatchesRegex("[0-9]+\\.[0-9]+\\.[0-9]+( \\(commit [0-9a-f]{12,}\\))?\n"));
}

TEST(CommandLine, TellsWhatIsThrown) {
  CommandLine line("program", "Does it.");
  testing::internal::CaptureStderr();
  EXPECT_EQ(RunWith(&line, {}, []() -> int { throw std::runtime_error("no such rig"); }), 1);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "program: no such rig\n");
  testing::internal::CaptureStderr();
  EXPECT_EQ(RunWith(&line, {}, []() -> int { throw std::runtime_error("two\nlines\n"); }), 1);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "program: two lines\n");
  testing::internal::CaptureStderr();
  EXPECT_EQ(RunWith(&line, {}, []() -> int { throw std::runtime_error("\x1b[2J\u202e\xff"); }), 1);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "program: ?[2J?\uFFFD\n");
  testing::internal::CaptureStderr();
  EXPECT_EQ(RunWith(&line, {}, []() -> int { throw UsageError("--a goes with --b"); }), 2);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "program: --a goes with --b; see program --help\n");
}

TEST(CommandLine, RunsTheVerbThatIsNamed) {
  std::string dir;
  CommandLine line("program", "Does one of two.");
  line.Verb("rest", "Does nothing.", [] { return 0; });
  line.Verb("work", "Does it.", [&] { return dir == "here" ? 5 : 6; })
      ->Required("DIR", &dir, "a folder");
  EXPECT_EQ(RunWith(&line, {"work", "here"}, nullptr), 5);
  testing::internal::CaptureStderr();
  EXPECT_EQ(RunWith(&line, {"play"}, nullptr), 2);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("there is no verb \"play\""));
  testing::internal::CaptureStderr();
  EXPECT_EQ(RunWith(&line, {}, nullptr), 2);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "program: which verb?; see program --help\n");
  testing::internal::CaptureStderr();
  EXPECT_EQ(RunWith(&line, {"work"}, nullptr), 2);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "program: DIR is required; see program work --help\n");
  testing::internal::CaptureStderr();
  EXPECT_EQ(RunWith(&line, {"work", "--dirr=here"}, nullptr), 2);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "program: DIR is required; not known: --dirr=here; see program work --help\n");
}

TEST(CommandLine, TellsWhatWasGivenBeItTheDefault) {
  CommandLine line("example", "Does nothing.");
  std::string rig = "here", camera = "rgb";
  line.Option("--rig", &rig, "a rig");
  line.Option("--camera", &camera, "one of its");
  EXPECT_EQ(RunWith(&line, {"--rig", "here"},
                    [&] { return line.Given("--rig") && !line.Given("--camera") ? 5 : 6; }),
            5);
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
