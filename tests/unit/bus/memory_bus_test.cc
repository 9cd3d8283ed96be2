#include <gtest/gtest.h>

#include <stdexcept>

#include "calib/model/errors.h"
#include "services/bus/bus.h"

namespace rgbdt {
namespace {

Bytes Of(int value) { return {static_cast<std::uint8_t>(value)}; }

class MemoryBusTest : public ::testing::Test {
 protected:
  Bus::Handler Note(const std::string& who) {
    return [this, who](const std::string& channel, const std::uint8_t* data, std::size_t size) {
      EXPECT_EQ(size, 1U);
      heard_.push_back(who + " " + channel + std::to_string(data[0]));
    };
  }

  MemoryBus bus_;
  std::vector<std::string> heard_;
};

TEST_F(MemoryBusTest, DeliversInTheOrderPublished) {
  bus_.Subscribe("A|B", Note("x"));
  bus_.Subscribe("B", Note("y"));
  bus_.Publish("B", Of(1));
  bus_.Publish("A", Of(2));
  bus_.Publish("C", Of(3));
  bus_.Publish("B", Of(4));
  EXPECT_TRUE(heard_.empty());
  bus_.Run();
  EXPECT_EQ(heard_, (std::vector<std::string>{"x B1", "y B1", "x A2", "x B4", "y B4"}));
}

TEST_F(MemoryBusTest, AnswersWaitUntilThoseBeforeAreDelivered) {
  bus_.Subscribe("Q", [&](const std::string&, const std::uint8_t* data, std::size_t) {
    heard_.push_back("Q" + std::to_string(data[0]));
    bus_.Publish("A", Of(data[0]));
  });
  bus_.Subscribe("A", Note("a"));
  bus_.Publish("Q", Of(1));
  bus_.Publish("Q", Of(2));
  bus_.Run();
  EXPECT_EQ(heard_, (std::vector<std::string>{"Q1", "Q2", "a A1", "a A2"}));
}

TEST_F(MemoryBusTest, ExpressionsMatchTheWholeName) {
  bus_.Subscribe("CLOUD", Note("c"));
  bus_.Subscribe(".*_IMAGE", Note("i"));
  for (const char* channel : {"RGBDT_CLOUD", "CLOUD2", "CLOUD", "RGB_IMAGE", "RGB_IMAGES"}) {
    bus_.Publish(channel, Of(0));
  }
  bus_.Run();
  EXPECT_EQ(heard_, (std::vector<std::string>{"c CLOUD0", "i RGB_IMAGE0"}));
  EXPECT_THROW(bus_.Subscribe("(", Note("")), InputError);
}

TEST_F(MemoryBusTest, SubscribersHearWhatIsPublishedAfterThem) {
  bus_.Subscribe("A", Note("first"));
  bus_.Publish("A", Of(1));
  bus_.Subscribe("A", Note("second"));
  bus_.Publish("A", Of(2));
  bus_.Run();
  EXPECT_EQ(heard_, (std::vector<std::string>{"first A1", "first A2", "second A2"}));
}

TEST_F(MemoryBusTest, ExceptionComesOutAndTheRestStillWaits) {
  bus_.Subscribe("BAD", [](const std::string&, const std::uint8_t*, std::size_t) {
    throw std::runtime_error("bad");
  });
  bus_.Subscribe("A", Note("a"));
  bus_.Publish("BAD", Of(1));
  bus_.Publish("A", Of(2));
  EXPECT_THROW(bus_.Run(), std::runtime_error);
  bus_.Run();
  EXPECT_EQ(heard_, (std::vector<std::string>{"a A2"}));
}

}  // namespace
}  // namespace rgbdt
