#include "services/command_line/command_line.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <utility>

#include "calib/model/version.h"

namespace rgbdt {
namespace {

CLI::Option* AddValue(CLI::App* app, const std::string& name, std::vector<std::string>* value,
                      const std::string& help) {
  return app->add_option(name, *value, help)->allow_extra_args(name.front() != '-');
}

CLI::Option* AddValue(CLI::App* app, const std::string& name, std::uint64_t* value,
                      const std::string& help) {  // CLI11 would take -1 for a large number
  return app->add_option(name, *value, help)->check(CLI::NonNegativeNumber);
}

template <typename T>
CLI::Option* AddValue(CLI::App* app, const std::string& name, T* value, const std::string& help) {
  return app->add_option(name, *value, help);
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

}  // namespace

CommandLine::CommandLine(const std::string& program, const std::string& description)
    : program_(std::make_unique<CLI::App>(description, program)), app_(program_.get()) {
  app_->set_version_flag("--version", Version());
}

CommandLine::CommandLine(CLI::App* verb) : app_(verb) {}

CommandLine::~CommandLine() = default;

CLI::Option* CommandLine::Add(const std::string& name, Value value, const std::string& help) {
  return std::visit(
      [&](auto* variable) {
        CLI::Option* option = AddValue(app_, name, variable, help);
        return IsEmpty(*variable) ? option : option->capture_default_str();
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
  Add(name, value, help)->check(CLI::Range(least, most));
}

void CommandLine::Flag(const std::string& name, bool* value, const std::string& help) {
  app_->add_flag(name, *value, help);
}

void CommandLine::ChoiceOf(const std::string& name, const std::vector<std::string>& names,
                           const std::string& help,
                           const std::function<void(const std::string&)>& choose) {
  app_->add_option_function<std::string>(name, choose, help)->check(CLI::IsMember(names));
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

int CommandLine::Run(int argc, char** argv, const std::function<int()>& run) {
  try {
    app_->parse(argc, argv);
    return run();
  } catch (const CLI::ParseError& e) {
    return app_->exit(e);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s: %s\n", app_->get_name().c_str(), e.what());
    return 1;
  }
}

int CommandLine::Run(int argc, char** argv) {
  const std::string verb = argc > 1 ? argv[1] : "";
  if (!verb.empty() && verb[0] != '-' && !HasVerb(*app_, verb)) {
    const char* const program = app_->get_name().c_str();
    std::fprintf(stderr, "%s: there is no verb \"%s\"; see %s --help\n", program, verb.c_str(),
                 program);
    return 1;
  }
  return Run(argc, argv, [this] { return chosen_(); });
}

}  // namespace rgbdt
