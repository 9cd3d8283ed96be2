#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "calib/model/errors.h"
#include "services/messages/codec.h"
#include "services/runtime/node.h"
#include "tests/nodes/nodes_testing.h"

namespace rgbdt::test {

/// Two nodes of a kind. One of them gets bad messages besides: after each that it refuses it must
/// be like the other, which never got it, in all that follows.
class Twins {
 public:
  /// What is not to be compared, e.g. how long something took, is to be made the same.
  using Normalise = std::function<void(Message* message)>;

  Twins(Node* node, Node* twin, Normalise normalise = {})
      : node_(node), twin_(twin), normalise_(std::move(normalise)) {}

  /// For both; before it and after it, all that is bad for the first of them.
  void Feed(const Messages& messages) {
    for (const Message& message : messages) {
      TryBad();
      Both([&](Node* node) { return node->Handle(message); });
      now_ += kMicrosecondsPerSecond / 5;
      Both([&](Node* node) { return node->Advance(now_); });
    }
    TryBad();
  }

  /// Messages that are refused in some states at least, or in all.
  Messages bad;
  /// How often each was refused.
  std::vector<int> refused;

 private:
  using Action = std::function<Messages(Node* node)>;

  void TryBad() {
    refused.resize(bad.size());
    for (std::size_t i = 0; i < bad.size(); ++i) {
      Messages answers;
      try {
        answers = node_->Handle(bad[i]);
      } catch (const InputError&) {
        ++refused[i];
        Compare({}, {});
        continue;
      }
      Compare(std::move(answers), twin_->Handle(bad[i]));  // here it is of use
    }
  }

  // A message may also be refused by both, for what was taken before.
  void Both(const Action& action) {
    std::string why, twins_why;
    Messages answers = AnswersOf(action, node_, &why);
    Messages twins_answers = AnswersOf(action, twin_, &twins_why);
    EXPECT_EQ(why, twins_why);
    Compare(std::move(answers), std::move(twins_answers));
  }

  static Messages AnswersOf(const Action& action, Node* node, std::string* why) {
    try {
      return action(node);
    } catch (const InputError& e) {
      *why = e.what();
      return {};
    }
  }

  void Compare(Messages a, Messages b) {
    for (Messages* messages : {&a, &b}) {
      for (Message& message : *messages) {
        if (normalise_) normalise_(&message);
      }
    }
    EXPECT_EQ(BytesOf(a), BytesOf(b));
    const Status status = node_->GetStatus();
    const Status expected = twin_->GetStatus();
    EXPECT_EQ(status.ready, expected.ready);
    EXPECT_EQ(status.text, expected.text);
    EXPECT_EQ(status.counters, expected.counters);
    EXPECT_EQ(node_->finished(), twin_->finished());
  }

  Node* node_;
  Node* twin_;
  Normalise normalise_;
  Utime now_ = 0;
};

}  // namespace rgbdt::test
