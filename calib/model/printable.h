#pragma once

#include <string>
#include <string_view>

namespace rgbdt {

/// Length of the well-formed UTF-8 character at `at`, or 0.
std::size_t Utf8Length(std::string_view text, std::size_t at);

/// Whether the character at `at`, of Utf8Length, does something to who shows it: it moves a
/// terminal's cursor, begins a line, or turns the text around it about (Unicode's C0 and C1
/// controls, U+007F, its separators of lines and paragraphs, its embeddings, overrides and isolates
/// of direction).
bool IsControl(std::string_view text, std::size_t at, std::size_t length);

/// `text` of a stranger, for what a person reads: U+FFFD for each byte that is not UTF-8, '?' for
/// each control character that is not among `kept`, such as "\n".
std::string PrintableText(std::string_view text, std::string_view kept = {});

/// Whether it is shown as it is, in one line.
inline bool IsPrintable(std::string_view text) { return PrintableText(text) == text; }

}  // namespace rgbdt
