#include "calib/present/report/said_once.h"

#include <algorithm>
#include <cctype>

#include "calib/present/report/words.h"

namespace rgbdt {
namespace {

constexpr std::size_t kNames = 8;

// What is alike, of one camera; then of several.
struct Group {
  std::vector<std::string> cameras, views;
  std::string key, text;  // the first view's

  bool SameOfAnother(const Group& other) const { return key == other.key && views == other.views; }
};

bool IsDigit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

bool IsOfAWord(const std::string& text, std::size_t at) {
  return at < text.size() && (std::isalnum(static_cast<unsigned char>(text[at])) != 0);
}

// The text with "#" for the name where that is a word.
std::string WithoutName(std::string text, const std::string& name) {
  for (std::size_t at = text.find(name); at != std::string::npos; at = text.find(name, at + 1)) {
    const bool word = (at == 0 || !IsOfAWord(text, at - 1)) && !IsOfAWord(text, at + name.size());
    if (word) text.replace(at, name.size(), "#");
  }
  return text;
}

// The text without what differs from view to view: its name, and numbers.
std::string KeyOf(const Said& said) {
  const std::string name = said.view.substr(said.view.rfind('/') + 1);
  std::string key;
  for (const char c : name.empty() ? said.text : WithoutName(said.text, name)) {
    if (!IsDigit(c)) key += c;
    if (IsDigit(c) && (key.empty() || key.back() != '#')) key += '#';
  }
  return key;
}

std::vector<Group> ByCamera(const std::vector<Said>& all) {
  std::vector<Group> groups;
  for (const Said& said : all) {
    const std::string key = KeyOf(said);
    const auto same = std::find_if(groups.begin(), groups.end(), [&](const Group& group) {
      return group.cameras.front() == said.camera && group.key == key;
    });
    if (same == groups.end()) {
      groups.push_back({{said.camera}, {said.view}, key, said.text});
    } else {
      same->views.push_back(said.view);
    }
  }
  return groups;
}

std::vector<Group> Merged(const std::vector<Group>& of_cameras) {
  std::vector<Group> groups;
  for (const Group& group : of_cameras) {
    const auto same = std::find_if(groups.begin(), groups.end(),
                                   [&](const Group& other) { return other.SameOfAnother(group); });
    if (same == groups.end()) {
      groups.push_back(group);
    } else {
      same->cameras.push_back(group.cameras.front());
    }
  }
  return groups;
}

std::string Line(const Group& group, const std::string& what) {
  const std::string cameras = Joined(group.cameras);
  std::string line = cameras.empty() ? "" : cameras + ": ";
  if (group.views.front().empty()) return line + group.text;
  if (group.views.size() == 1) {
    return line + "view " + group.views.front() + " " + what + ": " + group.text;
  }
  std::vector<std::string> names(
      group.views.begin(),
      group.views.begin() + static_cast<std::ptrdiff_t>(std::min(kNames, group.views.size())));
  if (group.views.size() > kNames) names.emplace_back("...");
  return line + Count(group.views.size(), "view") + " " + what + " (" + Joined(names) + "), " +
         group.views.front() + ": " + group.text;
}

}  // namespace

std::vector<std::string> SaidOnce(const std::vector<Said>& all, const std::string& what) {
  std::vector<std::string> lines;
  for (const Group& group : Merged(ByCamera(all))) lines.push_back(Line(group, what));
  return lines;
}

SaidAlike MostSaid(const std::vector<Said>& all) {
  SaidAlike most;
  for (const Group& group : ByCamera(all)) {
    if (group.views.size() <= most.count) continue;
    most = {group.views.size(), {group.cameras.front(), group.views.front(), group.text}};
  }
  return most;
}

std::vector<Said> OfViews(const std::vector<std::string>& lines) {
  const std::string begin = "view ";
  std::vector<Said> all;
  for (const std::string& line : lines) {
    const std::size_t colon = line.find(": ");
    if (line.rfind(begin, 0) == 0 && colon != std::string::npos) {
      all.push_back({"", line.substr(begin.size(), colon - begin.size()), line.substr(colon + 2)});
    } else {
      all.push_back({"", "", line});
    }
  }
  return all;
}

}  // namespace rgbdt
