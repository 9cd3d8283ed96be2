#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "calib/files/schema/session_script.h"
#include "calib/model/calibration.h"
#include "calib/model/rig.h"
#include "services/nodes/earlier_views.h"
#include "services/nodes/other_sessions.h"
#include "services/nodes/solver_views.h"
#include "services/nodes/step_timeout.h"
#include "services/nodes/unwritten_views.h"
#include "services/nodes/view_collector.h"
#include "services/runtime/node.h"
#include "services/runtime/periodic.h"

namespace rgbdt {

/// How far a session is, for a person.
struct SessionProgress {
  int step = 0;  ///< 1 to steps
  int steps = 0;
  std::string text;
  double fraction = 0;  ///< of this step
};

/// Runs a session, by a script or as a person asks in the viewer: sends commands, waits for the
/// answering events, writes the session directory. STATUS, SESSION_EVENT, SESSION_REQUEST, CLOUD,
/// `<CAMERA>_IMAGE`, CORNER_SELECTION, DETECTION, REPORT, LEFT_OUT_VIEWS -> RIG, SESSION_COMMAND,
/// SESSION_EVENT (how far it is), and the DETECTIONs once more. It begins when detector, solver,
/// fuser, the assembler of a turned scanner, and the processes of the rig file's devices are ready
/// (STATUS). next_pose and sweep end with anybody's done, capture with the detector's and the view
/// on disk, solve and evaluate with the solver's. save writes the report, and the calibration of
/// the cameras that were solved; results of an earlier run in the directory are kept aside
/// (SetResultsAside), once the session begins. A failed event, neither an answer nor new
/// progress in the step's time (StepTimeout), a camera that could not be solved, or results that
/// cannot be written end the session with the reason; one that a person leads publishes the reason
/// and goes on. Each capture that a person asks for is followed by solve and evaluate, so that
/// there always is a report. Corners that a person picks in an image of a view that is on disk are
/// written to it, and once the detector has detected it again, a session that a person leads solves
/// again.
///
/// A view that cannot be written stays in memory until it can (UnwrittenViews); its capture waits
/// for that, however long. No sweep begins where one more view could not be written: a script waits
/// for room, a person is refused with the reason.
///
/// Two sessions on one bus would erase each other's views. For as long as its identity says it
/// listens and sends nothing but its STATUS; hears it another one, it ends with the reason, and
/// nothing is written (OtherSessions). Later it warns of another one, on the page, too. What
/// answers another session's commands is ignored.
///
/// A directory with views of an earlier start of the session, that was ended or killed, is gone on
/// with (EarlierViews): the solver gets what it had, the script goes on after the last view that is
/// there with its detection, a person is asked for the next. What was asked for and not yet
/// answered is waited for: it is asked as it was, and who is at it, or has done it, answers. What
/// is there is not written over. A directory of another rig or script, or of a session that has
/// ended, is refused.
///
/// Detector and this process put each view together for themselves. What one of them lacks, as it
/// was started anew or messages were lost, the other one says again (ViewCollector::Again,
/// say_view). A capture whose sweep is whole for neither is taken again, sweep and all, kMaxRetakes
/// times at most; then it has failed. So is one for which this process took another image than the
/// detector, or that one of them still lacks when its time is over. So is one for which a process
/// was started anew (its STATUS counts from 0 again) that the sensors' messages come from, or the
/// detector twice, kMaxRestarts times; and what such a process was asked it is asked again. No
/// sweep begins until everybody is ready, by the newest STATUS; that of a process that is gone
/// counts until it is back (one at work is silent, too).
///
/// A command that is not answered is sent again, as it was, after 3, 6, 12 and then every 16 s; who
/// got it answers once more what it answered (NodeRunner). A process whose STATUS was not heard for
/// kCutOff and goes on with later numbers was cut off, and this one from it: what either said is
/// lost. The view at hand is taken again, once all are heard, and the solver sent all it needs.
/// Machines whose clocks are off, by anybody's STATUS, are named; no sweep of devices begins then,
/// nor in the next kClocksSettle (drivers take 2 s to see that a clock was set forward). A view
/// that is being taken when this is heard is taken again, as its stamps may be of before and after:
/// a clock that went forward within two seconds, one that went back after five (LinkReport). One
/// that swings is named, and ends no session.
///
/// A solver that was started anew has no views. Where its STATUS counts fewer than it had, or its
/// report was made without a view that was captured, it is sent all DETECTIONs and LEFT_OUT_VIEWS
/// once more, and is asked again what it was asked. A report without a captured view, but for those
/// that a person left out, is neither an answer nor saved. Advance's time serves time-outs and
/// waits, and RIG once a second.
class SessionNode : public Node {
 public:
  static constexpr int kMaxRetakes = 2;
  static constexpr int kMaxRestarts = 5;
  static constexpr Utime kCutOff = 3 * kMicrosecondsPerSecond;
  static constexpr Utime kClocksSettle = 5 * kMicrosecondsPerSecond;
  static constexpr Utime kFirstRepeat = 3 * kMicrosecondsPerSecond;
  static constexpr Utime kLongestRepeat = 16 * kMicrosecondsPerSecond;
  static constexpr int kMostExchanges = 3;  ///< of a view, 3 and 6 s apart

  using OnProgress = std::function<void(const SessionProgress&)>;
  /// Whether the person who carries the board has put it where the next view wants it; asked in
  /// each Advance until it has. What it throws ends the session.
  using BoardStands = std::function<bool()>;

  /// Throws InputError where the script makes no sense, and where `directory` holds views that are
  /// not to be gone on with: two sessions' views must not mix. With `board_stands` a pose may take
  /// as long as it does.
  SessionNode(SessionScript script, Rig rig, std::filesystem::path directory, OnProgress progress,
              BoardStands board_stands = {}, SessionIdentity identity = {});
  /// A session that a person leads, by SESSION_REQUEST.
  SessionNode(Rig rig, std::filesystem::path directory, OnProgress progress,
              SessionIdentity identity = {});

  std::string name() const override { return "session"; }
  std::vector<std::string> Subscriptions() const override {
    return {"STATUS",           "SESSION_EVENT", "SESSION_REQUEST", "CLOUD",         ".*_IMAGE",
            "CORNER_SELECTION", "DETECTION",     "REPORT",          "LEFT_OUT_VIEWS"};
  }
  Messages Handle(const Message& message) override;
  /// Goes on as far as possible.
  Messages Advance(Utime now) override;
  Status GetStatus() const override;
  bool finished() const override { return finished_; }
  /// A person's Enter is to be noticed.
  Utime LongestWait() const override { return 20'000; }

  /// The process ends: what is kept in memory is written where it can be by now. Returns what is
  /// lost and why, for a person; empty: nothing is.
  std::string WriteWhatIsKept();

  const std::string& failure() const { return failure_; }          ///< empty: none so far
  const std::optional<Report>& report() const { return report_; }  ///< of the newest solve

 private:
  const SessionStep& step() const { return script_.steps[index_]; }
  Messages GoOn();
  Messages Start();
  Messages GoOnWithEarlierViews();
  Messages GoOnWaiting();
  bool WaitsForPose() const;
  bool IsCaptured(const ViewDetection& detection) const;
  void PoseIsSet();
  void AskWhetherBoardStands();
  Messages Begin();
  bool IsHeldUp();
  Messages BeginCapture();
  Messages Send(SessionVerb verb);
  bool StepDone();
  bool IsDetected() const;
  std::string LostHere() const;
  void OnDetectorStartedAnew(const std::string& why);
  Messages SayWhatIsLacking();
  bool SolverTookAll();
  bool RestoreSolver(const std::string& why);
  void Take(const Message& message);
  void OnStatus(const Status& status);
  void OnStartedAnew(const std::string& process);
  void OnCutOff(const std::string& process, Utime silence);
  void OnClocks();
  static bool HasPart(const std::string& process);
  Messages RepeatCommand();
  std::string ClockTrouble() const;
  bool HasDevices() const;
  bool AnswersSweeps(const std::string& process) const;
  void AskAgain(const std::string& why);
  bool Listens() const;
  void OnRequest(const SessionRequest& request);
  void OnPicks(const CornerSelection& picks);
  void OnEvent(const SessionEvent& event);
  void SaveView();
  void SaveDetection(const std::string& view);
  void SaveLeftOut(const LeftOutViews& left_out);
  void WriteToDisk();
  std::string NoRoom();
  std::optional<std::size_t> SweepBefore() const;
  void TakeAgain(std::string why, int* tries, int most);
  void TakeTornAgain(const std::string& why) { TakeAgain(why, &retakes_, kMaxRetakes); }
  void Tell(const std::string& text);
  void Save();
  void SetEarlierResultsAside();
  void Fail(const std::string& why);
  void EndStep();
  void Append(SessionStep::Kind kind, bool heldout = false);
  void AppendCapture(bool heldout);
  bool CaptureIsHeldOut() const;
  void NoteAsked(const SessionCommand& command) const;
  bool idle() const { return by_request_ && started_ && index_ >= script_.steps.size(); }
  void PublishEvent(EventKind kind, const std::string& text, double fraction);
  void ReportProgress(const std::string& text, double fraction);
  void Announce(const std::string& text);
  std::string WithView(const std::string& text) const;
  std::vector<std::string> Needed() const;
  std::string WhoIsNotReady() const;
  std::string WhatIsMissing() const;
  std::string WhoIsSilent() const;
  std::string WhatIsOnDisk() const;

  SessionScript script_;
  bool by_request_ = false;
  Rig rig_;
  std::filesystem::path directory_;
  OnProgress progress_;
  BoardStands board_stands_;
  SessionIdentity identity_;
  OtherSessions others_{identity_.id};
  Periodic rig_repeat_{kMicrosecondsPerSecond};

  std::map<std::string, Status> statuses_;
  std::map<std::string, Utime> heard_;  // when
  Utime newest_utime_ = 0;
  Utime now_ = 0;               // Advance's newest
  std::optional<Utime> began_;  // its first
  StepTimeout timeout_;         // of the step at hand
  bool started_ = false;        // everybody was ready
  bool waiting_ = false;        // the step at hand was begun
  std::size_t index_ = 0;
  std::int64_t command_ = identity_.FirstCommand();
  SessionCommand newest_command_;
  Utime repeat_at_ = 0, repeat_pause_ = kFirstRepeat;  // of the newest command
  std::optional<Utime> cut_off_;                       // when somebody was heard again
  std::string clock_told_;
  std::optional<Utime> clocks_set_;  // when they were found to disagree, or to agree again
  bool answered_ = false;
  int view_number_ = 0;
  std::string view_;
  bool view_taken_ = false;  // captured: the next sweep is another view's
  std::string last_answer_;  // of the newest step that was answered
  std::map<std::pair<std::string, Utime>, std::string> images_;  // of views on disk: camera, utime
  std::map<std::int64_t, SessionCommand> captures_;              // by their numbers
  std::set<std::string> taken_;           // views of this start, on disk or not yet
  Messages events_;                       // not yet published
  std::set<std::string> newly_detected_;  // views whose detector's word is still to come
  SolverViews solver_views_;
  Messages again_;  // for the solver, not yet published
  Utime sweep_utime_ = 0;
  ViewCollector collector_;
  UnwrittenViews unwritten_{directory_, rig_};
  Periodic room_asked_{kMicrosecondsPerSecond};  // while the script waits for it
  std::string no_room_;
  bool has_view_ = false;  // of the capture at hand, on disk or not yet
  struct Exchange {
    std::string torn_here;       // why this process has no whole sweep; empty: it has, or none yet
    std::string detector_lacks;  // why the detector has not all of the view; empty: it has
    bool detector_is_new = false;  // it was started since the sweep began: it knows no capture
    View view;                     // as this process put it together, without its points
    int deaths = 0;                // of the detector, in this capture
    int tries = 0;
    Utime next_try = 0;
  };
  Exchange exchange_;    // with the detector, since the sweep began
  int retakes_ = 0;      // of the capture at hand: torn sweeps
  int restarts_ = 0;     // likewise: processes started anew
  std::string spoiled_;  // why the newest sweep is lost to who needs it; empty: it is not
  std::optional<Utime> held_up_since_;  // until everybody is ready
  EarlierViews earlier_;
  ResumePoint resume_;
  std::optional<Report> report_;
  bool finished_ = false;
  std::string failure_;
};

}  // namespace rgbdt
