#include "calib/files/import/internal/yaml_tree.h"

#include <yaml.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "calib/model/errors.h"
#include "calib/model/text.h"

namespace rgbdt::yaml {

struct Node::Document {
  Document(const std::string& text, const std::string& name) : file(name) {
    yaml_parser_t parser;
    if (yaml_parser_initialize(&parser) == 0) throw InputError(name + ": out of memory");
    yaml_parser_set_input_string(&parser, reinterpret_cast<const unsigned char*>(text.data()),
                                 text.size());
    const bool good = yaml_parser_load(&parser, &tree) != 0;
    const std::size_t line = parser.problem_mark.line + 1;
    const std::string problem = parser.problem == nullptr ? "damaged" : parser.problem;
    yaml_parser_delete(&parser);
    if (!good) throw InputError(name + ":" + std::to_string(line) + ": is not YAML: " + problem);
  }
  Document(const Document&) = delete;
  Document& operator=(const Document&) = delete;
  ~Document() { yaml_document_delete(&tree); }

  std::string file;
  mutable yaml_document_t tree{};  // libyaml's functions that only read it take it without const
};

namespace {

constexpr std::size_t kMostNumbers = 1000;
constexpr int kMostDepth = 4;
constexpr std::size_t kMostBytes = 4'000'000;
constexpr int kMostBrackets = 50;

// cv::FileStorage begins with "%YAML:1.0", which no YAML parser but OpenCV's takes: as a comment.
std::string WithoutDirective(const std::string& text) {
  return text.rfind("%YAML", 0) == 0 ? "#" + text.substr(1) : text;
}

// libyaml takes time with the square of how deep lists lie in each other.
void CheckExtent(const std::string& text, const std::string& file) {
  if (text.size() > kMostBytes) {
    throw InputError(file + " has " + std::to_string(text.size()) +
                     " bytes; expected a lens file, which is shorter");
  }
  int depth = 0;
  for (const char c : text) {
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
    if (depth > kMostBrackets)
      throw InputError(file + " has too many brackets open; expected YAML");
  }
}

std::string TextOf(const yaml_node_t& node) {
  const auto* const begin = reinterpret_cast<const char*>(node.data.scalar.value);
  return {begin, node.data.scalar.length};
}

}  // namespace

std::string Plain(const std::string& name) {
  std::string plain;
  for (const char c : ToLower(name)) {
    if (c != '_' && c != '-') plain += c;
  }
  return plain;
}

Node::Node(std::shared_ptr<const Document> document, int index, std::string name, std::size_t line)
    : document_(std::move(document)), index_(index), name_(std::move(name)), line_(line) {}

Node Node::Parse(const std::string& text, const std::string& file) {
  CheckExtent(text, file);
  const auto document = std::make_shared<const Document>(WithoutDirective(text), file);
  Node root(document, 1, "");
  if (root.Get() == nullptr || !root.IsTable()) {
    throw InputError(file + " holds no \"name: value\" lines; expected YAML");
  }
  return root;
}

yaml_node_s* Node::Get() const { return yaml_document_get_node(&document_->tree, index_); }

bool Node::IsTable() const { return Get()->type == YAML_MAPPING_NODE; }
bool Node::IsText() const { return Get()->type == YAML_SCALAR_NODE; }

std::vector<std::pair<std::string, Node>> Node::Entries() const {
  std::vector<std::pair<std::string, Node>> entries;
  if (!IsTable()) return entries;
  const auto& pairs = Get()->data.mapping.pairs;
  for (const yaml_node_pair_t* pair = pairs.start; pair != pairs.top; ++pair) {
    const Node key(document_, pair->key, name_);
    if (!key.IsText()) continue;
    const std::string name = TextOf(*key.Get());
    entries.emplace_back(name,
                         Node(document_, pair->value, name_.empty() ? name : name_ + "." + name,
                              key.Get()->start_mark.line + 1));
  }
  return entries;
}

std::optional<Node> Node::Find(std::initializer_list<const char*> names) const {
  for (const auto& [name, node] : Entries()) {
    const std::string plain = Plain(name);
    const bool found = std::any_of(names.begin(), names.end(),
                                   [&](const char* wanted) { return plain == Plain(wanted); });
    if (found) return node;
  }
  return std::nullopt;
}

std::string Node::Text() const {
  if (!IsText()) Fail("is a list or a table; expected a word");
  return TextOf(*Get());
}

std::vector<double> Node::Numbers() const {
  const std::optional<Node> data = Find({"data"});
  std::vector<double> numbers;
  (data ? *data : *this).AppendNumbers(0, &numbers);
  return numbers;
}

void Node::AppendNumbers(int depth, std::vector<double>* numbers) const {
  if (numbers->size() > kMostNumbers || depth > kMostDepth) Fail("holds too many numbers");
  if (IsTable()) Fail("is a table; expected numbers");
  if (IsText()) {
    numbers->push_back(Number());
    return;
  }
  const auto& items = Get()->data.sequence.items;
  // By aliases a few kilobytes could hold more empty lists than can be looked at.
  if (depth > 0 && items.start == items.top) Fail("holds an empty list; expected numbers");
  for (const yaml_node_item_t* item = items.start; item != items.top; ++item) {
    Node(document_, *item, name_).AppendNumbers(depth + 1, numbers);
  }
}

double Node::Number() const {
  const std::string text = Text();
  double value = 0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end.ec != std::errc() || end.ptr != text.data() + text.size() || !std::isfinite(value)) {
    Fail("holds \"" + text.substr(0, 40) + "\"; expected a number");
  }
  return value;
}

std::string Node::Describe() const {
  const std::size_t line = line_ > 0 ? line_ : Get()->start_mark.line + 1;
  return document_->file + ":" + std::to_string(line) + ": " + name_;
}

void Node::Fail(const std::string& problem) const { throw InputError(Describe() + " " + problem); }

}  // namespace rgbdt::yaml
