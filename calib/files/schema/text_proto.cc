#include "calib/files/schema/text_proto.h"

#include <google/protobuf/io/tokenizer.h>

#include <algorithm>
#include <sstream>

#include "calib/model/errors.h"
#include "calib/model/printable.h"
#include "calib/model/text.h"

namespace rgbdt::text {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::TextFormat;

// Where a line (from 0) begins in a text.
std::size_t BeginOfLine(const std::string& text, int line) {
  std::size_t at = 0;
  for (; line > 0; --line) {
    const std::size_t end = text.find('\n', at);
    if (end == std::string::npos) return text.size();
    at = end + 1;
  }
  return at;
}

std::string Quoted(const std::string& message, std::size_t at) {
  const std::size_t begin = message.find('"', at);
  if (begin == std::string::npos) return {};
  return message.substr(begin + 1, message.find('"', begin + 1) - begin - 1);
}

// Of Protobuf's words about a key that its message does not have: with the keys that it has.
std::string InWords(const std::string& message) {
  const std::size_t unknown = message.find(" has no field named ");
  if (unknown == std::string::npos) return message;
  std::string words = "unknown key \"" + Quoted(message, unknown) + "\"";
  const auto* type =
      google::protobuf::DescriptorPool::generated_pool()->FindMessageTypeByName(Quoted(message, 0));
  for (int i = 0; type != nullptr && i < type->field_count(); ++i) {
    words += (i == 0 ? "; expected one of: " : ", ") + type->field(i)->name();
  }
  return words;
}

// Keeps the first error; later ones only follow from it.
class FirstError : public google::protobuf::io::ErrorCollector {
 public:
  explicit FirstError(const std::string& source) : source_(source) {}

  void AddError(int line, google::protobuf::io::ColumnNumber column,
                const std::string& message) override {
    if (!text.empty()) return;
    text = (line < 0 ? " " : Position(line, column, message)) + InWords(message);  // -1: of no line
  }
  void AddWarning(int, google::protobuf::io::ColumnNumber, const std::string&) override {}

  std::string text;

 private:
  // Protobuf counts lines and columns from 0, and names the word after a wrong key or value: that
  // may stand lines below. So look for the word itself, which the message quotes.
  std::string Position(int line, int column, const std::string& message) const {
    std::size_t at =
        std::min(BeginOfLine(source_, line) + static_cast<std::size_t>(column), source_.size());
    for (const std::string before : {"has no field named \"", "Unknown enumeration value of \""}) {
      const std::size_t begin = message.find(before);
      if (begin == std::string::npos) continue;
      const std::size_t word = begin + before.size();
      const std::size_t found =
          source_.rfind(message.substr(word, message.find('"', word) - word), at);
      if (found != std::string::npos) at = found;
    }
    const std::size_t last = at == 0 ? std::string::npos : source_.rfind('\n', at - 1);
    const std::size_t in_line = last == std::string::npos ? at : at - last - 1;
    const auto lines =
        std::count(source_.begin(), source_.begin() + static_cast<std::ptrdiff_t>(at), '\n');
    return std::to_string(lines + 1) + ":" + std::to_string(in_line + 1) + ": ";
  }

  const std::string& source_;
};

std::string NamesOf(const google::protobuf::EnumDescriptor& type) {
  std::string names;
  for (int i = 0; i < type.value_count(); ++i) {
    if (type.value(i)->number() == 0) continue;  // unspecified
    names += (names.empty() ? "" : ", ") + type.value(i)->name();
  }
  return names;
}

// What Protobuf takes and nobody else would: numbers for names that there are not, and texts that
// break a line where they are printed. Element `i` of `field`, which may be repeated.
void CheckValue(const google::protobuf::Message& message, const FieldDescriptor* field, int i,
                const Place& place) {
  const auto* reflection = message.GetReflection();
  const bool repeated = field->is_repeated();
  if (field->cpp_type() == FieldDescriptor::CPPTYPE_STRING) {
    const std::string value = repeated ? reflection->GetRepeatedString(message, field, i)
                                       : reflection->GetString(message, field);
    if (IsPrintable(value)) return;
    place.Fail(field->name(), "is \"" + PrintableText(value) +
                                  "\", which has a line break or another control character, or "
                                  "bytes that are no UTF-8; expected text of one line");
  }
  if (field->cpp_type() == FieldDescriptor::CPPTYPE_ENUM) {
    const int value = repeated ? reflection->GetRepeatedEnumValue(message, field, i)
                               : reflection->GetEnumValue(message, field);
    if (field->enum_type()->FindValueByNumber(value) != nullptr) return;
    place.Fail(field->name(), "is " + std::to_string(value) +
                                  "; expected one of: " + NamesOf(*field->enum_type()));
  }
}

void CheckValues(const google::protobuf::Message& message, const Place& place) {
  const auto* reflection = message.GetReflection();
  std::vector<const FieldDescriptor*> fields;
  reflection->ListFields(message, &fields);
  for (const FieldDescriptor* field : fields) {
    const bool repeated = field->is_repeated();
    const int count = repeated ? reflection->FieldSize(message, field) : 1;
    const bool is_message = field->cpp_type() == FieldDescriptor::CPPTYPE_MESSAGE;
    for (int i = 0; i < count; ++i) {
      if (!is_message) {
        CheckValue(message, field, i, place);
        continue;
      }
      CheckValues(repeated ? reflection->GetRepeatedMessage(message, field, i)
                           : reflection->GetMessage(message, field),
                  place.In(field->name(), i));
    }
  }
}

int LineOf(const Place::Tree* tree, const FieldDescriptor* field, int index) {
  if (tree == nullptr || field == nullptr) return 0;
  return tree->GetLocation(field, field->is_repeated() ? index : -1).line + 1;
}

}  // namespace

Place Place::In(const std::string& field, int index) const {
  const FieldDescriptor* descriptor = type_->FindFieldByName(field);
  const int at = descriptor->is_repeated() ? index : -1;
  Place inner(file_, descriptor->message_type(),
              tree_ == nullptr ? nullptr : tree_->GetTreeForNested(descriptor, at));
  const int line = LineOf(tree_, descriptor, index);
  inner.line_ = line > 0 ? line : line_;
  inner.path_ = path_ + field + ".";
  return inner;
}

std::string Place::Describe(const std::string& field) const {
  int line = LineOf(tree_, type_->FindFieldByName(field), 0);
  if (line <= 0) line = line_;
  return file_ + (line > 0 ? ":" + std::to_string(line) : "") + ": " + path_ + field;
}

std::string Place::Describe() const {
  return file_ + (line_ > 0 ? ":" + std::to_string(line_) : "") + ": " +
         path_.substr(0, path_.empty() ? 0 : path_.size() - 1);
}

void Place::Fail(const std::string& field, const std::string& problem) const {
  throw InputError(Describe(field) + " " + problem);
}

Place ParseText(const std::string& text, const std::string& file,
                google::protobuf::Message* message, Place::Tree* tree) {
  TextFormat::Parser parser;
  FirstError error(text);
  parser.RecordErrorsTo(&error);
  parser.WriteLocationsTo(tree);
  // Deeper than any of the schemas, and far from the end of the stack.
  parser.SetRecursionLimit(50);
  // Checked first: Protobuf would only print to stderr.
  if (ValidUtf8(text) != text) {
    throw InputError(file + ": is not UTF-8 text; expected a text file in Protobuf's text format");
  }
  if (!parser.ParseFromString(text, message)) {
    throw InputError(file + ":" + (error.text.empty() ? " cannot be parsed" : error.text));
  }
  Place place(file, message->GetDescriptor(), tree);
  CheckValues(*message, place);
  return place;
}

std::string PrintText(const google::protobuf::Message& message, const std::string& comment) {
  std::string out;
  std::istringstream lines(comment);
  for (std::string line; std::getline(lines, line);) out += "# " + line + "\n";
  TextFormat::Printer printer;
  printer.SetUseShortRepeatedPrimitives(true);
  printer.SetUseUtf8StringEscaping(true);
  std::string body;
  printer.PrintToString(message, &body);
  return out + body;
}

}  // namespace rgbdt::text
