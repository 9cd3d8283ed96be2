#include <gmock/gmock.h>

#include "tests/unit/doctor/doctor_testing.h"

namespace rgbdt {
namespace {

FirewallFacts With(const std::string& ruleset) { return {7667, true, true, ruleset}; }

// As `nft list ruleset` prints it.
constexpr const char* kRule =
    "table ip lcm {\n"
    "\tchain input {\n"
    "\t\ttype filter hook input priority filter; policy accept;\n"
    "\t\tudp dport 7667 fib saddr type != local drop\n"
    "\t}\n"
    "}\n";

std::string Changed(const std::string& from, const std::string& to) {
  std::string rule = kRule;
  return rule.replace(rule.find(from), from.size(), to);
}

TEST(DoctorFirewall, TheRuleThatIsAdvisedIsFound) {
  EXPECT_THAT(CheckFirewall(With(kRule)), Is(kOk));
  EXPECT_THAT(CheckFirewall(With(Changed("7667", "{ 7000, 7667 }"))), Is(kOk));
  EXPECT_THAT(CheckFirewall(With(Changed("local drop", "local counter packets 3 bytes 9 drop"))),
              Is(kOk));
}

TEST(DoctorFirewall, AnythingElseIsNot) {
  for (const std::string& ruleset :
       {std::string(), Changed("7667", "7668"), Changed("7667", "17667"),
        Changed("7667", "{ 17667, 76670 }"), Changed("drop", "accept"),
        Changed("hook input", "hook output"), Changed(" fib saddr type != local", ""),
        Changed("!=", "=="), Changed("\t\tudp", "\t}\n\tchain mine {\n\t\tudp")}) {
    EXPECT_THAT(CheckFirewall(With(ruleset)),
                Says(kWarning, "UDP port 7667", "sudo nft add table ip lcm; "))
        << ruleset;
  }
}

TEST(DoctorFirewall, NothingIsSaidWhereNothingIsKnownOrNobodyReachesIt) {
  EXPECT_THAT(CheckFirewall({7667, true, false, ""}), Is(kOk));
  EXPECT_THAT(CheckFirewall({7667, false, false, ""}), Is(kOk));
}

}  // namespace
}  // namespace rgbdt
