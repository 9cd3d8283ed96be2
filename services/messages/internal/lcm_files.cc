#include "services/messages/internal/lcm_files.h"

#include <cctype>
#include <stdexcept>
#include <utility>

namespace rgbdt {
namespace {

bool IsWord(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

// Words and single characters, without spaces and comments.
class Tokens {
 public:
  explicit Tokens(std::string_view text) : text_(text) { Next(); }

  bool AtEnd() const { return token_.empty(); }

  std::string_view Take() {
    if (AtEnd()) throw std::logic_error(".lcm: the text ends within a struct");
    const std::string_view token = token_;
    Next();
    return token;
  }

  std::string TakeWord() {
    const std::string_view token = Take();
    if (!IsWord(token.front())) {
      throw std::logic_error(".lcm: a name was expected, not " + std::string(token));
    }
    return std::string(token);
  }

  bool TakeIf(std::string_view token) {
    if (token_ != token) return false;
    Next();
    return true;
  }

  void Expect(std::string_view token) {
    const std::string_view found = Take();
    if (found == token) return;
    throw std::logic_error(".lcm: " + std::string(token) + " was expected, not " +
                           std::string(found));
  }

 private:
  void Next() {
    SkipBlank();
    std::size_t end = 0;
    while (end < text_.size() && IsWord(text_[end])) ++end;
    if (end == 0 && !text_.empty()) end = 1;
    token_ = text_.substr(0, end);
    text_.remove_prefix(end);
  }

  void SkipBlank() {
    while (!text_.empty()) {
      if (std::isspace(static_cast<unsigned char>(text_.front())) != 0) {
        text_.remove_prefix(1);
      } else if (text_.substr(0, 2) == "//") {
        SkipBeyond("\n");
      } else if (text_.substr(0, 2) == "/*") {
        SkipBeyond("*/");
      } else {
        return;
      }
    }
  }

  void SkipBeyond(std::string_view mark) {
    const std::size_t at = text_.find(mark, 2);
    text_.remove_prefix(at == std::string_view::npos ? text_.size() : at + mark.size());
  }

  std::string_view text_;   // beyond token_
  std::string_view token_;  // empty: the text has ended
};

// `float x_m[num_points], y_m[num_points];`
void ParseFields(Tokens* tokens, std::vector<LcmField>* fields) {
  const std::string type = tokens->TakeWord();
  do {
    LcmField field{type, tokens->TakeWord(), {}};
    while (tokens->TakeIf("[")) {
      field.sizes.push_back(tokens->TakeWord());
      tokens->Expect("]");
    }
    fields->push_back(std::move(field));
  } while (tokens->TakeIf(","));
  tokens->Expect(";");
}

LcmType ParseType(Tokens* tokens) {
  LcmType type;
  tokens->Expect("struct");
  type.name = tokens->TakeWord();
  tokens->Expect("{");
  while (!tokens->TakeIf("}")) {
    if (tokens->TakeIf("const")) {
      while (tokens->Take() != ";") continue;
    } else {
      ParseFields(tokens, &type.fields);
    }
  }
  return type;
}

}  // namespace

std::vector<LcmType> ParseLcm(std::string_view text) {
  std::vector<LcmType> types;
  for (Tokens tokens(text); !tokens.AtEnd();) {
    if (tokens.TakeIf("package")) {
      tokens.TakeWord();
      tokens.Expect(";");
    } else {
      types.push_back(ParseType(&tokens));
    }
  }
  return types;
}

}  // namespace rgbdt
