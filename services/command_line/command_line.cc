#include "services/command_line/command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <sstream>
#include <utility>

#include "calib/model/printable.h"
#include "calib/model/text.h"
#include "calib/model/version.h"
#include "services/command_line/commit.h"

namespace rgbdt {
namespace {

// A check that --help does not name: `problem` gives what is wrong with a value, or nothing.
CLI::Validator Check(const std::function<std::string(const std::string&)>& problem) {
  return {problem, "", ""};
}

CLI::Validator NotNegative() {
  return Check([](const std::string& given) {
    return !given.empty() && given.front() == '-' ? given + " is less than 0" : std::string();
  });
}

CLI::Validator Between(double least, double most) {
  return Check([=](const std::string& given) {
    double value = 0;
    const bool good = CLI::detail::lexical_cast(given, value) && value >= least && value <= most;
    return good ? std::string() : given + " is not within " + Exact(least) + " to " + Exact(most);
  });
}

CLI::Option* AddValue(CLI::App* app, const std::string& name, std::vector<std::string>* value,
                      const std::string& help) {
  return app->add_option(name, *value, help)->allow_extra_args(name.front() != '-');
}

CLI::Option* AddValue(CLI::App* app, const std::string& name, std::uint64_t* value,
                      const std::string& help) {  // CLI11 would take -1 for a large number
  return app->add_option(name, *value, help)->check(NotNegative());
}

template <typename T>
CLI::Option* AddValue(CLI::App* app, const std::string& name, T* value, const std::string& help) {
  return app->add_option(name, *value, help);
}

std::string Joined(const std::vector<std::string>& words, const char* separator) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : separator) + word;
  return text;
}

// The default as --help shows it.
template <typename T>
void ShowDefault(const T& /*value*/, CLI::Option* option) {
  option->capture_default_str();
}
void ShowDefault(const std::vector<std::string>& value, CLI::Option* option) {
  option->default_str(Joined(value, " "));
}

template <typename T>
bool IsEmpty(const T& value) {
  return value.empty();
}
bool IsEmpty(double) { return false; }
bool IsEmpty(int) { return false; }
bool IsEmpty(std::uint64_t) { return false; }

bool HasVerb(const CLI::App& app, const std::string& name) {
  return !app.get_subcommands([&](const CLI::App* verb) { return verb->get_name() == name; })
              .empty();
}

// "0.1.0", or "0.1.0 (commit 0123456789ab)" where the build knew it.
std::string VersionText() {
  const std::string commit = Commit();
  return Version() + (commit.empty() ? "" : " (commit " + commit + ")");
}

// What others throw may have lines, and a stranger's file or its name what moves a terminal's
// cursor.
std::string OneLine(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return PrintableText(text);
}

// After the names of a choice: in its line, or in lines of its own.
std::string Explained(const std::string& help) {
  if (help.empty()) return "";
  return (help.find('\n') == std::string::npos ? ": " : ":\n") + help;
}

// Longer lines of an option's help are broken where a word ends.
std::string Wrapped(const std::string& help) {
  constexpr std::size_t kLongest = 92;
  std::istringstream lines(help);
  std::string text;
  for (std::string line; std::getline(lines, line);) {
    text += text.empty() ? "" : "\n";
    while (line.size() > kLongest) {
      std::size_t end = line.rfind(' ', kLongest);
      if (end == std::string::npos) end = line.find(' ');  // a word that is longer
      if (end == std::string::npos) break;
      text += line.substr(0, end) + "\n";
      line.erase(0, end + 1);
    }
    text += line;
  }
  return text;
}

class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_option_desc(const CLI::Option* option) const override {
    return Wrapped(CLI::Formatter::make_option_desc(option));
  }
};

// In the columns that options have.
std::string Footer(const std::map<ExitCode, std::string>& ends) {
  const std::string indent(29, ' ');
  std::string text = "Exit codes:";
  for (const auto& [code, when] : ends) {
    text += "\n  " + std::to_string(static_cast<int>(code)) + indent.substr(2);
    for (const char c : when) text += c == '\n' ? "\n " + indent : std::string(1, c);
  }
  return text;
}

}  // namespace

CommandLine::CommandLine(const std::string& program, const std::string& description)
    : program_(std::make_unique<CLI::App>(description, program)),
      app_(program_.get()),
      ends_(UsualEnds()) {
  app_->formatter(std::make_shared<HelpFormatter>());
  app_->set_version_flag("--version", VersionText());
  app_->footer(Footer(ends_));
}

CommandLine::CommandLine(CLI::App* verb) : app_(verb), ends_(UsualEnds()) {
  app_->footer(Footer(ends_));
}

CommandLine::~CommandLine() = default;

CLI::Option* CommandLine::Add(const std::string& name, Value value, const std::string& help) {
  return std::visit(
      [&](auto* variable) {
        CLI::Option* option = AddValue(app_, name, variable, help);
        if (!IsEmpty(*variable)) ShowDefault(*variable, option);
        return option;
      },
      value);
}

void CommandLine::Option(const std::string& name, Value value, const std::string& help) {
  Add(name, value, help);
}

void CommandLine::Required(const std::string& name, Value value, const std::string& help) {
  Add(name, value, help)->required();
}

void CommandLine::Within(const std::string& name, double* value, double least, double most,
                         const std::string& help) {
  Add(name, value, help + ", " + Exact(least) + " to " + Exact(most))->check(Between(least, most));
}

void CommandLine::Two(const std::string& name, std::string* first, std::string* second,
                      const std::string& what, const std::string& help) {
  using Words = std::pair<std::string, std::string>;
  app_->add_option_function<Words>(
          name,
          [=](const Words& words) {
            *first = words.first;
            *second = words.second;
          },
          help)
      ->type_name(what);
}

void CommandLine::Flag(const std::string& name, bool* value, const std::string& help) {
  app_->add_flag(name, *value, help);
}

void CommandLine::Bus(std::string* url, std::string* key) {
  Option("--lcm-url", url, "the bus; default: LCM_DEFAULT_URL");
  Option("--key", key,
         "file of the rig's key (rgbdt key): what commands the rig is signed with it, and what\n"
         "is not is ignored; default: RGBDT_KEY, or else no key");
}

void CommandLine::ChoiceOf(const std::string& name, std::vector<std::string> names,
                           const std::string& usual, const std::string& help,
                           const std::function<void(const std::string&)>& choose) {
  std::sort(names.begin(), names.end(), NaturalLess);
  const std::string all = Joined(names, ", ");
  const auto check = [=](const std::string& given) {
    const bool good = std::find(names.begin(), names.end(), given) != names.end();
    return good ? std::string() : "\"" + given + "\" is none of " + all;
  };
  app_->add_option_function<std::string>(name, choose, all + Explained(help))
      ->check(Check(check))
      ->type_name("NAME")
      ->default_str(usual);
}

bool CommandLine::Given(const std::string& name) const { return app_->count(name) > 0; }

void CommandLine::Ends(ExitCode code, const std::string& when) {
  ends_[code] = when;
  app_->footer(Footer(ends_));
}

void CommandLine::Rest(std::vector<std::string>* words) {
  app_->prefix_command();
  app_->callback([this, words] { *words = app_->remaining(); });
}

CommandLine* CommandLine::Verb(const std::string& name, const std::string& description,
                               std::function<int()> run) {
  app_->require_subcommand(1);
  CLI::App* verb = app_->add_subcommand(name, description);
  verb->callback([this, run = std::move(run)] { chosen_ = run; });
  verbs_.push_back(std::unique_ptr<CommandLine>(new CommandLine(verb)));
  return verbs_.back().get();
}

// The program, and the verb where one was named.
std::string CommandLine::Called() const {
  const std::vector<CLI::App*> verbs = app_->get_subcommands();
  return app_->get_name() + (verbs.empty() ? "" : " " + verbs.front()->get_name());
}

// Options that were given and are none, for an error about another one: it may be this one
// misspelt.
std::string CommandLine::Unknown() const {
  std::vector<std::string> words = app_->remaining(true);
  words.erase(std::remove_if(words.begin(), words.end(),
                             [](const std::string& word) { return word.rfind('-', 0) != 0; }),
              words.end());
  return words.empty() ? "" : "; not known: " + Joined(words, ", ");
}

int CommandLine::Run(int argc, char** argv, const std::function<int()>& run) {
  const auto fail = [&](ExitCode code, const std::string& why) {
    std::fprintf(stderr, "%s: %s\n", app_->get_name().c_str(), OneLine(why).c_str());
    return static_cast<int>(code);
  };
  const auto misused = [&](const std::string& why) {
    return fail(ExitCode::kUsage, why + "; see " + Called() + " --help");
  };
  try {
    app_->parse(argc, argv);
    return run();
  } catch (const CLI::Success& help) {
    return app_->exit(help);
  } catch (const CLI::RequiredError& e) {
    const bool no_verb = !verbs_.empty() && app_->get_subcommands().empty();
    return misused(no_verb ? "which verb?" : e.what() + Unknown());
  } catch (const CLI::ParseError& e) {
    return misused(e.what());
  } catch (const UsageError& e) {
    return misused(e.what());
  } catch (const std::exception& e) {
    return fail(ExitCode::kFailed, e.what());
  }
}

int CommandLine::Run(int argc, char** argv) {
  const std::string verb = argc > 1 ? argv[1] : "";
  if (verb.empty() || (verb[0] != '-' && !HasVerb(*app_, verb))) {
    const char* const program = app_->get_name().c_str();
    const std::string what =
        verb.empty() ? "which verb?" : "there is no verb \"" + OneLine(verb) + "\"";
    std::fprintf(stderr, "%s: %s; see %s --help\n", program, what.c_str(), program);
    return static_cast<int>(ExitCode::kUsage);
  }
  return Run(argc, argv, [this] { return chosen_(); });
}

}  // namespace rgbdt
