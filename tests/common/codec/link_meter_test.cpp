// SPDX-License-Identifier: Apache-2.0
#include "common/codec/link_meter.h"

#include <gtest/gtest.h>

#include <deque>
#include <utility>

namespace goldthread {
namespace {

using std::chrono::duration;
using std::chrono::duration_cast;
using Time = LinkMeter::Time;

Time at(double seconds) { return Time(duration_cast<Time::duration>(duration<double>(seconds))); }

/// A link that carries `rate` bytes/s in order, and a peer that looks every `poll` seconds.
class Link {
 public:
  Link(double rate, double poll) : rate_(rate), poll_(poll) {}

  void send(LinkMeter& meter, std::size_t bytes, double now) {
    deliver(meter, now);
    free_ = std::max(free_, now) + static_cast<double>(bytes) / rate_;
    if (const auto serial = meter.sent(bytes, at(now))) {
      // Seen when the peer looks next, and the answer when this rank does.
      receipts_.emplace_back(serial, free_ + poll_);
    }
  }
  /// All receipts that have come by `now`.
  void deliver(LinkMeter& meter, double now) {
    while (!receipts_.empty() && receipts_.front().second <= now) {
      meter.received(receipts_.front().first, at(receipts_.front().second));
      receipts_.pop_front();
    }
  }
  double free() const { return free_; }

 private:
  double rate_, poll_;
  double free_ = 0;
  std::deque<std::pair<std::uint32_t, double>> receipts_;
};

TEST(LinkMeter, FindsWhatASaturatedLinkCarries) {
  for (const double rate : {12e6, 119.6e6, 1.2e9}) {
    LinkMeter meter;
    Link link(rate, 0.5e-3);
    // 16 MB in tiles of 80 kB, all at once: the sends are long over before the bytes are there.
    for (int i = 0; i < 200; ++i) link.send(meter, 80'000, 1e-5 * i);
    link.deliver(meter, 100);
    ASSERT_TRUE(meter.bytes_per_second());
    EXPECT_LE(*meter.bytes_per_second(), 1.05 * rate);
    EXPECT_GE(*meter.bytes_per_second(), 0.8 * rate);
  }
}

TEST(LinkMeter, AFastLinkLooksFastWhateverThePeersSleepIs) {
  LinkMeter meter;
  Link link(10e9, 1e-3);
  for (int i = 0; i < 24; ++i) link.send(meter, 256 * 1024, 1e-6 * i);
  link.deliver(meter, 1);
  ASSERT_TRUE(meter.bytes_per_second());
  EXPECT_GT(*meter.bytes_per_second(), 1.5e9);
}

TEST(LinkMeter, ALinkThatIsHardlyUsedSaysNothing) {
  LinkMeter meter;
  Link link(119.6e6, 0.5e-3);
  for (int i = 0; i < 1000; ++i) link.send(meter, 20'000, 5e-3 * i);
  link.deliver(meter, 100);
  EXPECT_FALSE(meter.bytes_per_second());
}

TEST(LinkMeter, PausesBetweenTrainsDoNotMakeTheLinkLookSlow) {
  LinkMeter meter;
  Link link(119.6e6, 0.5e-3);
  double now = 0;
  for (int train = 0; train < 10; ++train) {
    for (int i = 0; i < 30; ++i) link.send(meter, 100'000, now);
    now = link.free() + 1;
    link.deliver(meter, now);
    EXPECT_TRUE(meter.is_idle());
  }
  ASSERT_TRUE(meter.bytes_per_second());
  EXPECT_NEAR(*meter.bytes_per_second(), 119.6e6, 6e6);
}

TEST(LinkMeter, OnePeerThatSleptDoesNotMakeTheLinkSlow) {
  LinkMeter meter;
  Link quick(1e9, 0.5e-3), sleepy(1e9, 50e-3);
  for (int i = 0; i < 20; ++i) quick.send(meter, 256 * 1024, 0);
  quick.deliver(meter, 1);
  const double before = *meter.bytes_per_second();
  for (int i = 0; i < 20; ++i) sleepy.send(meter, 256 * 1024, 2);
  sleepy.deliver(meter, 3);
  EXPECT_EQ(*meter.bytes_per_second(), before);
}

TEST(LinkMeter, ALinkThatBecameSlowIsFoundOut) {
  LinkMeter meter;
  Link fast(1e9, 0.5e-3), slow(20e6, 0.5e-3);
  for (int i = 0; i < 40; ++i) fast.send(meter, 256 * 1024, 0);
  fast.deliver(meter, 1);
  EXPECT_GT(*meter.bytes_per_second(), 0.7e9);
  for (int i = 0; i < 400; ++i) slow.send(meter, 256 * 1024, 2);
  slow.deliver(meter, 100);
  EXPECT_NEAR(*meter.bytes_per_second(), 20e6, 2e6);
}

TEST(LinkMeter, AsksForFewReceipts) {
  LinkMeter meter;
  int asked = 0;
  for (int i = 0; i < 1000; ++i) asked += meter.sent(16 * 1024, at(0)) != 0 ? 1 : 0;
  EXPECT_NEAR(asked, 1000 / 16, 2);
}

TEST(LinkMeter, ReceiptsThatNobodyAskedForAreIgnored) {
  LinkMeter meter;
  const auto serial = meter.sent(8 << 20, at(0));
  meter.received(serial + 1, at(1));
  meter.received(0, at(1));
  EXPECT_FALSE(meter.bytes_per_second());
  EXPECT_FALSE(meter.is_idle());
  meter.received(serial, at(1));
  meter.received(serial, at(1.001));
  ASSERT_TRUE(meter.bytes_per_second());
  EXPECT_DOUBLE_EQ(*meter.bytes_per_second(), 8 << 20);
}

}  // namespace
}  // namespace goldthread
