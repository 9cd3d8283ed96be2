// Every figure that a person reads stands in GLOSSARY.md.
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "calib/files/schema/report.pb.h"
#include "calib/present/report/comparison_text.h"
#include "calib/present/report/report_content.h"
#include "calib/present/report/session_verdict.h"
#include "calib/present/report/summary.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using ::testing::Contains;
using ::testing::Not;

// What stands in backticks, and what stands there before "(": `Views used` explains
// "Views used (8)".
std::set<std::string> Glossary() {
  std::ifstream file(std::string(RGBDT_SOURCE_DIR) + "/calib/present/report/GLOSSARY.md");
  std::ostringstream text;
  text << file.rdbuf();
  const std::string page = text.str();
  static const std::regex term("`([^`\n]+)`");
  std::set<std::string> terms;
  for (std::sregex_iterator it(page.begin(), page.end(), term), end; it != end; ++it) {
    terms.insert((*it)[1]);
  }
  return terms;
}

// Two cameras with all that a report may hold.
Report FullReport(const std::string& method) {
  Report report = test::MakeReport();
  report.method = method;
  report.cameras[0].calibration.range_errors = test::MakeRangeErrors();
  report.cameras[0].calibration.timing = CameraTiming{{0.012, 1e-5}, {0.02, 1e-5}};
  report.cameras[0].truth_error = PoseError{1, 2};
  return report;
}

// The labels of a terminal's table, which stand before columns and end with the seconds.
std::set<std::string> LabelsOf(const std::string& table) {
  std::set<std::string> labels;
  std::istringstream lines(table);
  for (std::string line; std::getline(lines, line);) {
    labels.insert(line.rfind("method ", 0) == 0 ? "method" : line.substr(0, line.find("  ")));
    if (line.rfind("seconds", 0) == 0) break;
  }
  return labels;
}

// Without what differs from report to report.
std::string General(std::string text) {
  for (const auto& [pattern, general] : {std::pair{"^(Views (used|held out)) \\(\\d+\\)$", "$1"},
                                         {"^Image of .*", "Image of CAMERA"},
                                         {"^ring \\d+$", "ring N"},
                                         {"^intensity [\\d.]+$", "intensity X"}}) {
    text = std::regex_replace(text, std::regex(pattern), general);
  }
  return text;
}

// Titles, heads, and the names of rows whose column has none.
void AddTerms(const Table& table, std::set<std::string>* terms) {
  terms->insert(table.title);
  for (const std::string& head : table.head) terms->insert(General(head));
  if (table.head.empty() || !table.head.front().empty()) return;
  for (const Row& row : table.rows) terms->insert(General(row.front().text));
}

std::set<std::string> FieldsOf(const google::protobuf::Descriptor& message,
                               std::set<std::string> fields = {}) {
  for (int i = 0; i < message.field_count(); ++i) {
    const google::protobuf::FieldDescriptor& field = *message.field(i);
    if (!fields.insert(field.name()).second) continue;
    if (field.message_type() != nullptr) fields = FieldsOf(*field.message_type(), fields);
  }
  return fields;
}

void ExpectExplained(std::set<std::string> terms, std::size_t at_least) {
  terms.erase("");
  EXPECT_GE(terms.size(), at_least);
  const std::set<std::string> glossary = Glossary();
  for (const std::string& term : terms) EXPECT_THAT(glossary, Contains(term));
}

TEST(Glossary, HasEveryLineOfTheTerminal) {
  std::set<std::string> labels;
  for (const char* method : {"auto", "paper"}) {
    const std::string text = Summary(FullReport(method)).FullReport();
    labels.merge(LabelsOf(text.substr(text.find("method "))));  // below the verdicts
  }
  labels.insert("next view");
  ExpectExplained(labels, 21);
}

TEST(Glossary, HasEveryTableOfTheReport) {
  std::set<std::string> terms;
  for (const char* method : {"auto", "paper"}) {
    const Report report = FullReport(method);
    const ReportContent content = ContentOf(report);
    for (const CameraContent& camera : content.cameras) {
      for (const Table& table : camera.tables) AddTerms(table, &terms);
    }
    for (const Table& table : content.tables) AddTerms(table, &terms);
    AddTerms(HeldoutTable({{"rgb", true, 8, &report.cameras[0]}}), &terms);
  }
  ExpectExplained(terms, 60);
}

TEST(Glossary, HasEveryFieldOfTheReportFile) {
  std::set<std::string> fields = FieldsOf(*proto::Report::descriptor());
  fields.erase("key");  // of the map of cameras; its "value" is an Estimate's, too
  ExpectExplained(fields, 80);
}

TEST(Glossary, HasEveryLineOfAComparison) {
  PoseComparison camera;
  camera.camera = "rgb";
  camera.pixels = {{2, 0.1, {}}};
  CalibrationComparison comparison;
  comparison.cameras = {camera};
  const std::string text = ComparisonText(comparison);
  std::istringstream lines(text);
  std::set<std::string> labels;
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("  ", 0) != 0) continue;
    const std::string label = line.substr(2, line.find("  ", 2) - 2);
    labels.insert(label.rfind("colours at", 0) == 0 ? "colours at" : label);
  }
  ExpectExplained(labels, 3);
}

TEST(Glossary, TheTestItselfCanFail) {
  EXPECT_THAT(Glossary(), Not(Contains("RMS distance to nothing")));
  EXPECT_THAT(LabelsOf("method auto       rgb\na label              -\nseconds  1\nrgb: words\n"),
              testing::ElementsAre("a label", "method", "seconds"));
}

}  // namespace
}  // namespace rgbdt
