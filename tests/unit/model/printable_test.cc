#include "calib/model/printable.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calib/model/text.h"

namespace rgbdt {
namespace {

TEST(PrintableText, KeepsNamesOfAnyScript) {
  // The last: joiners and marks that scripts of both directions need.
  for (const std::string name : {"", "view 0001", "\u0432\u0438\u0434 \u8996\u91ce \U0001F321",
                                 "\u05e6\u05e4\u05d9", "\u00a0\u00e9\u2027\u202f\u2065\u206a\uffff",
                                 "\u0645\u06cc\u200c\u062e\u200f\u200e\u200d"}) {
    EXPECT_EQ(PrintableText(name), name);
    EXPECT_TRUE(IsPrintable(name)) << name;
  }
}

TEST(PrintableText, ReplacesWhatDoesSomething) {
  for (const char* control : {"\n",     "\r",     "\t",     "\x1b",   "\x7f",   "\u0080", "\u0085",
                              "\u009b", "\u009f", "\u2028", "\u2029", "\u202a", "\u202b", "\u202c",
                              "\u202d", "\u202e", "\u2066", "\u2067", "\u2068", "\u2069"}) {
    EXPECT_EQ(PrintableText(std::string("a") + control + "b"), "a?b");
    EXPECT_FALSE(IsPrintable(control));
  }
  EXPECT_EQ(PrintableText(std::string(1, '\0')), "?");
  EXPECT_EQ(PrintableText("a\nb\u0085\x7f", "\n\t"), "a\nb??");
}

TEST(PrintableText, IsUtf8AsValidUtf8MakesIt) {
  for (const char* text :
       {"a\xff z", "\xC0\xAF", "\xED\xA0\x80", "\xE2\x82", "\xF4\x90\x80\x80", "\xC2", "\x9b"}) {
    EXPECT_EQ(PrintableText(text), ValidUtf8(text));
    EXPECT_FALSE(IsPrintable(text));
  }
}

}  // namespace
}  // namespace rgbdt
