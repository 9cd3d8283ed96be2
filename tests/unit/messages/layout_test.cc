#include "services/messages/internal/layout.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>

#include "tests/unit/messages/codec_testing.h"

namespace rgbdt {
namespace {

using ::testing::ElementsAre;
using testing::ErrorOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(Lcm, FieldsAreReadAndConstantsPassedOver) {
  const auto types = ParseLcm(R"(package test; // struct not_t { int8_t a; }
    /* struct nor_t { int8_t a; } */
    struct a_t{
      int32_t num_rows,num_columns;  // [m]
      double rows [num_rows][ 3 ];
      const int8_t A = -1, B = 2;
      b_t part;
    }
    struct b_t { string s; })");
  ASSERT_EQ(types.size(), 2U);
  EXPECT_EQ(types[0].name, "a_t");
  ASSERT_EQ(types[0].fields.size(), 4U);
  EXPECT_EQ(types[0].fields[1].type, "int32_t");
  EXPECT_EQ(types[0].fields[1].name, "num_columns");
  EXPECT_THAT(types[0].fields[1].sizes, IsEmpty());
  EXPECT_THAT(types[0].fields[2].sizes, ElementsAre("num_rows", "3"));
  EXPECT_EQ(types[0].fields[3].type, "b_t");
  EXPECT_EQ(types[1].fields[0].name, "s");
}

std::string WhyNot(const std::string& lcm) {
  try {
    const Layouts layouts(ParseLcm(lcm));
  } catch (const std::logic_error& e) {
    return e.what();
  }
  return "no error";
}

TEST(Lcm, WhatIsNotUnderstoodIsRefused) {
  EXPECT_EQ(WhyNot("struct a_t { int8_t a; }"), "no error");
  EXPECT_THAT(WhyNot("struct a_t { int8_t a;"), HasSubstr("the text ends"));
  EXPECT_THAT(WhyNot("enum a_t { A }"), HasSubstr("struct was expected, not enum"));
  EXPECT_THAT(WhyNot("struct a_t { int8_t a b; }"), HasSubstr("; was expected, not b"));
  EXPECT_THAT(WhyNot("struct a_t { test.b_t b; }"), HasSubstr("a name was expected, not ."));
  EXPECT_THAT(WhyNot("struct a_t { }"), HasSubstr("a_t has no fields"));
  EXPECT_THAT(WhyNot("struct a_t { uint8_t a; }"), HasSubstr("a_t.a: unknown type uint8_t"));
  EXPECT_THAT(WhyNot("struct a_t { int8_t a[n]; int32_t n; }"), HasSubstr("no field n before it"));
  EXPECT_THAT(WhyNot("struct a_t { int8_t n; int8_t a[n]; }"), HasSubstr("a_t.n: a count is"));
  EXPECT_THAT(WhyNot("struct a_t { int32_t n[2]; int8_t a[n]; }"), HasSubstr("a_t.n: a count is"));
  EXPECT_THAT(WhyNot("struct a_t { b_t b; int8_t a[n]; } struct b_t { int32_t n; }"),
              HasSubstr("no field n before it"));
}

// A fingerprint, then these bytes.
std::string ErrorIn(const std::string& fields, const Bytes& bytes) {
  const Layouts layouts(ParseLcm("struct a_t {" + fields +
                                 "} struct b_t { int32_t n; int16_t v[n]; } "
                                 "struct c_t { int8_t v[2]; }"));
  Bytes whole = bytes;
  whole.insert(whole.begin(), 8, 0);
  return ErrorOf([&] { layouts.Check("a_t", whole.data(), whole.size()); });
}

TEST(Layout, TakesExactlyTheBytesOfItsFields) {
  const std::string all =
      "int64_t a; double b; int32_t c; float d; int16_t e; int8_t f, g[2][3];"
      "boolean h; byte i; c_t j[2];";
  EXPECT_EQ(ErrorIn(all, Bytes(39)), "no error");
  EXPECT_THAT(ErrorIn(all, Bytes(38)), HasSubstr("v needs 2 bytes at byte 45 of 46"));
  EXPECT_THAT(ErrorIn(all, Bytes(40)), HasSubstr("1 bytes more than its fields take"));
  const Bytes six(6);
  const Layouts layouts(ParseLcm("struct a_t { int8_t a; }"));
  EXPECT_THAT(ErrorOf([&] { layouts.Check("a_t", six.data(), six.size()); }),
              HasSubstr("the fingerprint needs 8 bytes"));
}

TEST(Layout, CountsAreThoseOfTheirOwnStruct) {
  const std::string fields = "int32_t n; b_t part[n]; int8_t v[n];";
  EXPECT_EQ(ErrorIn(fields, {0, 0, 0, 2, 0, 0, 0, 1, 9, 9, 0, 0, 0, 0, 8, 8}), "no error");
  EXPECT_THAT(ErrorIn(fields, {0, 0, 0, 2, 0, 0, 0, 1, 9, 9, 0, 0, 0, 1, 8, 8}),
              HasSubstr("v needs 2 bytes at byte 24 of 24"));
}

TEST(Layout, EmptyArraysTakeNoBytes) {
  EXPECT_EQ(ErrorIn("int32_t n; double v[n][3]; string s[n]; b_t b[2][n];", Bytes(4)), "no error");
}

TEST(Layout, ForgedCounts) {
  EXPECT_THAT(ErrorIn("int32_t n; double v[n];", {0xff, 0xff, 0xff, 0xff}), "n is -1");
  const Bytes most = {0x7f, 0xff, 0xff, 0xff, 0x7f, 0xff, 0xff, 0xff};
  EXPECT_THAT(ErrorIn("int32_t n, m; double v[n][m][1000];", most), HasSubstr("v needs"));
  EXPECT_THAT(ErrorIn("int32_t n, m; string v[n][m];", most), HasSubstr("v needs"));
  EXPECT_THAT(ErrorIn("int32_t n, m; b_t v[n][m];", most), HasSubstr("v needs"));
  // Nothing in two billion rows: a decoder would make the rows.
  EXPECT_THAT(ErrorIn("int32_t n, m; double v[n][m];", {0x7f, 0xff, 0xff, 0xff, 0, 0, 0, 0}),
              HasSubstr("v needs"));
  EXPECT_EQ(ErrorIn("int32_t n, m; double v[n][m];", {0, 0, 0, 0, 0x7f, 0xff, 0xff, 0xff}),
            "no error");
  EXPECT_EQ(ErrorIn("int32_t n, m; int8_t v[n][m][2];", {0, 0, 0, 2, 0, 0, 0, 1, 1, 2, 3, 4}),
            "no error");
}

TEST(Layout, Strings) {
  const std::string two = "string a; string b;";
  EXPECT_EQ(ErrorIn(two, {0, 0, 0, 1, 0, 0, 0, 0, 3, 'x', 'y', 0}), "no error");
  EXPECT_THAT(ErrorIn("string a;", {0, 0, 0, 0, 0}), "length of a is 0");
  EXPECT_THAT(ErrorIn("string a;", {0xff, 0xff, 0xff, 0xff, 0}), "length of a is -1");
  EXPECT_THAT(ErrorIn("string a;", {0, 0, 0, 3, 'x', 0}), HasSubstr("a needs 3 bytes"));
  EXPECT_THAT(ErrorIn("string a;", {0, 0, 0, 2, 'x', 'y'}), HasSubstr("only NUL"));
  EXPECT_THAT(ErrorIn("string a;", {0, 0, 0, 2, 0, 0}), HasSubstr("only NUL"));
}

}  // namespace
}  // namespace rgbdt
