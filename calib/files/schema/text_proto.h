#pragma once

// For the files of this folder and of session/: Protobuf text with error messages that name file,
// line and key.

#include <google/protobuf/message.h>
#include <google/protobuf/text_format.h>

#include <string>

namespace rgbdt::text {

/// Where a message stands in a file, so that an error about one of its fields can say so.
class Place {
 public:
  using Tree = google::protobuf::TextFormat::ParseInfoTree;

  /// `tree` may be null: then there are no line numbers. It must outlive the place.
  Place(std::string file, const google::protobuf::Descriptor* type, const Tree* tree)
      : file_(std::move(file)), type_(type), tree_(tree) {}

  /// The place of a message inside this one; `index` where the field is repeated.
  Place In(const std::string& field, int index = 0) const;

  /// "rig.textproto:12: camera.width"
  std::string Describe(const std::string& field) const;

  /// "rig.textproto:12: camera", the message itself.
  std::string Describe() const;

  /// Throws InputError("rig.textproto:12: camera.width " + problem).
  [[noreturn]] void Fail(const std::string& field, const std::string& problem) const;

  const std::string& file() const { return file_; }

 private:
  std::string file_;
  const google::protobuf::Descriptor* type_;
  const Tree* tree_;
  int line_ = 0;      // where the message itself begins, from 1; 0: unknown
  std::string path_;  // "camera."
};

/// Parses `text` into `message` and fills `tree`. Throws InputError with file, line, column and
/// what is wrong (an unknown key is named), also for a string with control characters and for a
/// number in place of a name that there is not.
Place ParseText(const std::string& text, const std::string& file,
                google::protobuf::Message* message, Place::Tree* tree);

/// The message as text; each line of `comment` goes on top behind a '#'. Same message, same bytes.
std::string PrintText(const google::protobuf::Message& message, const std::string& comment);

}  // namespace rgbdt::text
