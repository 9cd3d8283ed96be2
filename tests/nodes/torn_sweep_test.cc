// Sweeps of which lines never came: who has them says them again; where nobody has, they are taken
// again.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calib/files/session/session_dir.h"
#include "services/nodes/session_node.h"
#include "tests/nodes/session_world.h"
#include "tests/unit/files/test_data.h"

namespace rgbdt {
namespace {

using test::Only;
using test::TinyRig;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using Kind = SessionStep::Kind;
using Verb = SessionVerb;

// The sweep's end tells of a line more than came.
Messages Torn(Messages answer) {
  for (Message& message : answer) {
    if (auto* chunk = std::get_if<CloudChunk>(&message)) {
      chunk->cloud.first_line = 1;
      chunk->sweep_lines = 2;
    }
  }
  return answer;
}

// As the detector answers where its sweep is not whole.
Messages RefusedByDetector(const Messages& answer, Utime sweep_utime) {
  Messages out;
  for (Message message : answer) {
    if (std::holds_alternative<ViewDetection>(message)) continue;
    if (auto* event = std::get_if<SessionEvent>(&message); event && event->source == "detector") {
      event->kind = EventKind::kFailed;
      event->sweep_utime = sweep_utime;
      event->text = "the sweep is not whole";
    }
    out.push_back(std::move(message));
  }
  return out;
}

// What did not come to the session, though the detector had it. Of kImageLost another one came.
template <typename Where>
Messages Lost(Where where, Messages answer) {
  Messages out;
  Utime newest = 0;
  for (Message& message : answer) {
    if (const auto* image = std::get_if<Image>(&message)) newest = image->utime;
    if (where == Where::kDetectionLost && std::holds_alternative<ViewDetection>(message)) continue;
    if (where == Where::kImagesLost && std::holds_alternative<Image>(message)) continue;
    auto* detection = std::get_if<ViewDetection>(&message);
    if (where == Where::kImageLost && detection != nullptr) {
      detection->images.emplace_back();
      detection->images.back().camera = "rgb";
      detection->images.back().utime = newest + 1;
      detection->images.back().why_not = "made up";
    }
    out.push_back(std::move(message));
  }
  return out;
}

class TornSweepTest : public ::testing::Test {
 protected:
  enum class Where {
    kNowhere,
    kBoth,
    kDetector,
    kSession,
    kDetectionLost,
    kImagesLost,
    kImageLost
  };

  void Lead(std::unique_ptr<SessionNode> node) {
    node_ = std::move(node);
    node_->SetWarningHandler([&](const std::string& warning) { warnings_.push_back(warning); });
    for (const char* process : {"assembler", "detector", "solver", "fuser"}) {
      node_->Handle(test::Ready(process));
    }
  }
  void ByScript(const std::vector<Kind>& kinds) {
    Lead(std::make_unique<SessionNode>(test::Script(kinds), TinyRig(), dir_ / "session",
                                       SessionNode::OnProgress()));
  }
  // The first `torn` sweeps are torn; half a minute, or until the session ends.
  void Run(Where where, int torn) {
    for (int turn = 0; turn < 300 && !node_->finished(); ++turn) {
      const Messages said = test::AdvanceTo(now_s_ += 0.1, node_.get());
      for (const SessionEvent& event : Only<SessionEvent>(said)) events_.push_back(event);
      for (const SessionCommand& command : Only<SessionCommand>(said)) {
        Messages answer = world_.Answer(command);
        const bool this_one = command.verb == Verb::kSweep ? sweeps_++ < torn : sweeps_ <= torn;
        if (this_one && command.verb == Verb::kSweep) {
          whole_ = answer;
          if (where == Where::kSession || where == Where::kBoth) answer = Torn(std::move(answer));
        }
        if (this_one && command.verb == Verb::kCapture) {
          captured_ = answer;
          capture_ = command;
          if (where == Where::kDetector || where == Where::kBoth) {
            answer = RefusedByDetector(answer, command.sweep_utime);
          }
          answer = Lost(where, std::move(answer));
        }
        if (command.verb == Verb::kSayView && detector_answers_) answer = ViewAgain();
        test::HandleAll(node_.get(), answer);
      }
      const std::vector<CloudChunk> told = Only<CloudChunk>(said);
      if (!told.empty()) ++told_;
      for (const CloudChunk& chunk : told) EXPECT_EQ(chunk.seq, kSaidAgain);
      if (!told.empty() && detector_answers_) test::HandleAll(node_.get(), world_.Detect(capture_));
    }
  }
  // As the detector says it: the images, then the sweep, then what it found.
  Messages ViewAgain() const {
    Messages again;
    for (const Message& message : captured_) {
      if (std::holds_alternative<Image>(message)) again.push_back(message);
    }
    for (const Message& message : whole_) {
      if (std::holds_alternative<CloudChunk>(message)) again.push_back(message);
    }
    for (Message& message : again) SetSeq(kSaidAgain, &message);
    for (Message& word : world_.Detect(capture_)) again.push_back(std::move(word));
    return again;
  }
  void Anew() {
    std::filesystem::remove_all(dir_ / "session");
    world_ = test::World();
    warnings_.clear();
    sweeps_ = told_ = 0;
    ByScript(one_view_);
  }
  std::vector<Verb> Verbs() const {
    std::vector<Verb> verbs;
    for (const SessionCommand& command : world_.commands) verbs.push_back(command.verb);
    return verbs;
  }

  const std::vector<Kind> one_view_ = {Kind::kNextPose, Kind::kSweep,    Kind::kCapture,
                                       Kind::kSolve,    Kind::kEvaluate, Kind::kSave};
  test::TempDir dir_;
  test::World world_;
  std::unique_ptr<SessionNode> node_;
  double now_s_ = 0;
  int sweeps_ = 0;
  bool detector_answers_ = true;  // to what is said for it alone
  Messages whole_, captured_;     // as the newest sweep and capture were answered
  SessionCommand capture_;
  int told_ = 0;  // times a view was said again to the detector
  std::vector<SessionEvent> events_;
  std::vector<std::string> warnings_;
};

TEST_F(TornSweepTest, SweepAndCaptureAreRepeatedWhereBothLackLines) {
  Anew();
  Run(Where::kBoth, SessionNode::kMaxRetakes);
  EXPECT_TRUE(node_->finished());
  EXPECT_EQ(node_->failure(), "");
  EXPECT_THAT(Verbs(), ElementsAre(Verb::kReset, Verb::kNextPose, Verb::kSweep, Verb::kCapture,
                                   Verb::kSweep, Verb::kCapture, Verb::kSweep, Verb::kCapture,
                                   Verb::kSolve, Verb::kEvaluate));
  const Session session = OpenSession(dir_ / "session");
  ASSERT_THAT(session.views, ElementsAre("0001"));
  const View view = ReadView(session, "0001");
  EXPECT_EQ(view.cloud.sweep_utime, world_.commands[7].sweep_utime);
  EXPECT_EQ(view.cloud.lines, 1);
  EXPECT_THAT(warnings_, ::testing::Each(AllOf(HasSubstr("view 0001"), HasSubstr("is not whole"),
                                               HasSubstr("the sweep is taken again"))));
  EXPECT_EQ(warnings_.size(), 2U);
}

TEST_F(TornSweepTest, WhatTheDetectorLacksItIsToldOnceAndNothingIsTakenAgain) {
  Anew();
  Run(Where::kDetector, 1);
  EXPECT_TRUE(node_->finished());
  EXPECT_EQ(node_->failure(), "");
  EXPECT_THAT(Verbs(), ElementsAre(Verb::kReset, Verb::kNextPose, Verb::kSweep, Verb::kCapture,
                                   Verb::kSolve, Verb::kEvaluate));
  EXPECT_EQ(told_, 1);
  EXPECT_THAT(warnings_, ElementsAre(AllOf(HasSubstr("view 0001: detector: the sweep is not whole"),
                                           HasSubstr("it is told the view again"))));
}

TEST_F(TornSweepTest, WhatIsLostOnItsWayHereTheDetectorIsAskedFor) {
  for (const auto& [where, words] : {std::pair(Where::kDetectionLost, "lacks the view's DETECTION"),
                                     std::pair(Where::kImagesLost, "lacks an image of camera rgb"),
                                     std::pair(Where::kSession, "1 of its 2 lines never came")}) {
    Anew();
    Run(where, 1);
    EXPECT_TRUE(node_->finished());
    EXPECT_EQ(node_->failure(), "");
    EXPECT_THAT(Verbs(), ElementsAre(Verb::kReset, Verb::kNextPose, Verb::kSweep, Verb::kCapture,
                                     Verb::kSayView, Verb::kSolve, Verb::kEvaluate));
    EXPECT_THAT(warnings_,
                ElementsAre(AllOf(HasSubstr(words), HasSubstr("rgbdt-detector is asked for it"))));
    ASSERT_THAT(OpenSession(dir_ / "session").views, ElementsAre("0001"));
    EXPECT_EQ(LostLines(ReadView(OpenSession(dir_ / "session"), "0001").cloud), 0);
  }
}

// The detector may have been started anew since, or one is of another version.
TEST_F(TornSweepTest, WhatNobodySaysAgainIsTakenAgain) {
  detector_answers_ = false;
  for (const auto& [where, words] : {std::pair(Where::kDetectionLost, "lacks the view's DETECTION"),
                                     std::pair(Where::kDetector, "no answer in 10 s"),
                                     std::pair(Where::kSession, "1 of its 2 lines never came")}) {
    Anew();
    Run(where, 1);
    EXPECT_TRUE(node_->finished());
    EXPECT_EQ(node_->failure(), "");
    EXPECT_EQ(sweeps_, 2);
    ASSERT_EQ(warnings_.size(), static_cast<std::size_t>(SessionNode::kMostExchanges) + 1);
    EXPECT_THAT(warnings_.back(), AllOf(HasSubstr(words), HasSubstr("the sweep is taken again")));
  }
}

// The session has written another one already.
TEST_F(TornSweepTest, AnImageThatTheDetectorDidNotHaveIsTakenAgain) {
  Anew();
  Run(Where::kImageLost, 1);
  EXPECT_EQ(node_->failure(), "");
  EXPECT_THAT(Verbs(), ElementsAre(Verb::kReset, Verb::kNextPose, Verb::kSweep, Verb::kCapture,
                                   Verb::kSweep, Verb::kCapture, Verb::kSolve, Verb::kEvaluate));
  EXPECT_THAT(warnings_,
              ElementsAre(AllOf(HasSubstr("image of camera rgb that rgbdt-detector has was lost"),
                                HasSubstr("taken again"))));
}

TEST_F(TornSweepTest, AfterThreeItSaysWhyItGivesUp) {
  Anew();
  Run(Where::kBoth, 100);
  EXPECT_TRUE(node_->finished());
  EXPECT_THAT(node_->failure(),
              AllOf(HasSubstr("step 3 of 6, capture, view 0001"), HasSubstr("is not whole"),
                    HasSubstr("given up after 3 sweeps")));
  EXPECT_EQ(sweeps_, 3);
}

TEST_F(TornSweepTest, EachViewHasItsOwnTries) {
  std::vector<Kind> two_views = {Kind::kNextPose, Kind::kSweep, Kind::kWait, Kind::kCapture};
  two_views.insert(two_views.end(), one_view_.begin(), one_view_.end());
  ByScript(two_views);
  Run(Where::kBoth, SessionNode::kMaxRetakes);
  EXPECT_EQ(node_->failure(), "");
  EXPECT_EQ(sweeps_, 4);
  EXPECT_THAT(OpenSession(dir_ / "session").views, ElementsAre("0001", "0002"));
}

TEST_F(TornSweepTest, ASweepThatIsNotRightBeforeTheCaptureIsNotGuessed) {
  ByScript({Kind::kSweep, Kind::kSolve, Kind::kCapture});
  Run(Where::kBoth, 1);
  EXPECT_THAT(node_->failure(), HasSubstr("put sweep before capture"));
  EXPECT_EQ(sweeps_, 1);
}

TEST_F(TornSweepTest, APersonIsAskedNothingUntilItIsGivenUp) {
  Lead(std::make_unique<SessionNode>(TinyRig(), dir_ / "session", SessionNode::OnProgress()));
  Run(Where::kNowhere, 0);
  SessionRequest request;
  request.request = SessionRequestKind::kCapture;
  node_->Handle(request);
  Run(Where::kBoth, 1);
  EXPECT_THAT(Verbs(), ElementsAre(Verb::kReset, Verb::kSweep, Verb::kCapture, Verb::kSweep,
                                   Verb::kCapture, Verb::kSolve, Verb::kEvaluate));
  EXPECT_EQ(events_.back().kind, EventKind::kDone);
  EXPECT_THAT(OpenSession(dir_ / "session").views, ElementsAre("0001"));
  EXPECT_TRUE(std::any_of(events_.begin(), events_.end(), [](const SessionEvent& event) {
    return event.text.find("the sweep is taken again") != std::string::npos;
  })) << "the page hears of it";

  node_->Handle(request);
  Run(Where::kBoth, 100);
  EXPECT_EQ(events_.back().kind, EventKind::kFailed);
  EXPECT_THAT(events_.back().text, HasSubstr("given up"));
  EXPECT_FALSE(node_->finished());
  node_->Handle(request);
  Run(Where::kNowhere, 0);
  EXPECT_EQ(node_->failure(), "");
  EXPECT_THAT(OpenSession(dir_ / "session").views, ElementsAre("0001", "0003"));
}

}  // namespace
}  // namespace rgbdt
