#pragma once

// YAML for lens files: a tree of nodes that know where they stand.

#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

struct yaml_document_s;
struct yaml_node_s;

namespace rgbdt::yaml {

/// The first document of a text, also as cv::FileStorage writes it. Lives as long as any of its
/// nodes.
class Node {
 public:
  /// Throws InputError with `file` and line where it is not YAML, or not a table of names and
  /// values.
  static Node Parse(const std::string& text, const std::string& file);

  bool IsTable() const;
  bool IsText() const;
  /// Of a table, in the file's order; names as they stand there.
  std::vector<std::pair<std::string, Node>> Entries() const;
  /// The entry that has one of these names, of which neither case nor - and _ count; absent: none.
  std::optional<Node> Find(std::initializer_list<const char*> names) const;

  /// Throws InputError where it is none.
  std::string Text() const;
  /// All numbers of a list, of a list of lists, or of a table's list "data"; or a single one.
  std::vector<double> Numbers() const;
  double Number() const;

  /// "camera.yaml:12: K"
  std::string Describe() const;
  /// Throws InputError("camera.yaml:12: K " + problem).
  [[noreturn]] void Fail(const std::string& problem) const;

 private:
  struct Document;
  /// `line` 0: where the node itself begins.
  Node(std::shared_ptr<const Document> document, int index, std::string name, std::size_t line = 0);
  yaml_node_s* Get() const;
  void AppendNumbers(int depth, std::vector<double>* numbers) const;

  std::shared_ptr<const Document> document_;
  int index_;
  std::string name_;
  std::size_t line_;
};

/// A name in lower case and without - and _.
std::string Plain(const std::string& name);

}  // namespace rgbdt::yaml
