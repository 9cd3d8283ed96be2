#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "calib/model/errors.h"
#include "services/command_line/exit_codes.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace rgbdt {

/// What the user gave on the command line makes no sense. The program ends with ExitCode::kUsage.
class UsageError : public InputError {
 public:
  using InputError::InputError;
};

/// The options of a program, or of one of its verbs, with `--help` and `--version`. Behind it is
/// CLI11, which is compiled here only: its header costs each source that uses it ten seconds.
///
/// An option is named "--name", or "NAME" where its value stands for itself. What its variable
/// holds before is the default, which `--help` shows unless it is empty. Variables outlive Run.
class CommandLine {
 public:
  using Value =
      std::variant<std::string*, double*, int*, std::uint64_t*, std::vector<std::string>*>;

  CommandLine(const std::string& program, const std::string& description);
  ~CommandLine();

  /// A vector takes one value each time that its option is given; one that is named "NAME", all
  /// values.
  void Option(const std::string& name, Value value, const std::string& help);
  void Required(const std::string& name, Value value, const std::string& help);
  /// From `least` to `most`.
  void Within(const std::string& name, double* value, double least, double most,
              const std::string& help);
  /// Two words behind it, `what` in --help: "CERT KEY".
  void Two(const std::string& name, std::string* first, std::string* second,
           const std::string& what, const std::string& help);
  /// Given or not, without a value.
  void Flag(const std::string& name, bool* value, const std::string& help);
  /// "--lcm-url" and "--key", of a process on the bus.
  void Bus(std::string* url, std::string* key);
  /// One of `choices`, by name; `--help` has the names before `help`.
  template <typename T, typename Variable>
  void Choice(const std::string& name, Variable* value, const std::map<std::string, T>& choices,
              const std::string& help) {
    std::vector<std::string> names;
    std::string usual;
    names.reserve(choices.size());
    for (const auto& choice : choices) {
      names.push_back(choice.first);
      if (*value == choice.second) usual = choice.first;
    }
    ChoiceOf(name, names, usual, help,
             [=](const std::string& chosen) { *value = choices.at(chosen); });
  }
  void Choice(const std::string& name, std::string* value, const std::vector<std::string>& names,
              const std::string& help) {
    ChoiceOf(name, names, *value, help, [=](const std::string& chosen) { *value = chosen; });
  }
  /// All from the first word on that is no option.
  void Rest(std::vector<std::string>* words);

  /// Whether the user gave this option, be it its default.
  bool Given(const std::string& name) const;

  /// When the program or verb ends with this code, for `--help`; in place of what is said there of
  /// every program.
  void Ends(ExitCode code, const std::string& when);

  /// What `program NAME ...` does: `run` gives the exit code. Its options are added to what
  /// returns.
  CommandLine* Verb(const std::string& name, const std::string& description,
                    std::function<int()> run);

  /// Reads what the user gave, then calls `run`; returns the exit code. What is wrong with the
  /// options, or is thrown by `run`, goes to stderr, in one line.
  int Run(int argc, char** argv, const std::function<int()>& run);
  /// The same for a program of verbs.
  int Run(int argc, char** argv);

 private:
  explicit CommandLine(CLI::App* verb);
  CLI::Option* Add(const std::string& name, Value value, const std::string& help);
  void ChoiceOf(const std::string& name, std::vector<std::string> names, const std::string& usual,
                const std::string& help, const std::function<void(const std::string&)>& choose);
  std::string Called() const;
  std::string Unknown() const;

  std::unique_ptr<CLI::App> program_;  // none: this is a verb, which its program owns
  CLI::App* app_;
  std::vector<std::unique_ptr<CommandLine>> verbs_;
  std::function<int()> chosen_;
  std::map<ExitCode, std::string> ends_;
};

}  // namespace rgbdt
