// SPDX-License-Identifier: Apache-2.0
// Whatever a page or a stranger sends, only that connection suffers: each test ends with a good
// page that is served.

#include <gtest/gtest.h>

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <list>
#include <random>
#include <string>

#include "client.h"
#include "compositor/gateway/event_queue.h"
#include "compositor/gateway/gateway.h"
#include "compositor/gateway/page_message.h"

namespace goldthread {
namespace {

using namespace testing_client;
using Json = nlohmann::json;
using tcp = boost::asio::ip::tcp;

constexpr const char* kSession = "/session?token=secret";
const Json kHello{{"type", "hello"}, {"protocol", 2}};
constexpr std::uint16_t kPolicy = 1008;

GatewayOptions options(GatewayLimits limits = {}) {
  GatewayOptions options;
  options.port = 0;
  options.token = "secret";
  options.limits = limits;
  return options;
}

class HostileTest : public testing::Test {
 protected:
  explicit HostileTest(GatewayLimits limits = {}) : gateway_(options(limits)) {
    gateway_.set_welcome(R"({"type":"welcome","protocol":2})");
  }
  void TearDown() override {
    Page good = enter();
    EXPECT_EQ(good.expect("welcome").at("protocol"), 2);
    good.send({{"type", "ping"}, {"time", 42}});
    EXPECT_EQ(good.expect("pong").at("time"), 42);
  }
  Page enter() {
    Page page(gateway_.port(), kSession);
    page.send(kHello);
    return page;
  }
  Incoming closed_after(const std::string& text) {
    Page page = enter();
    page.send(text);
    return page.closed();
  }

  Gateway gateway_;
};

TEST_F(HostileTest, MalformedMessagesCloseWithPolicyAndAReason) {
  const std::string bad[] = {"",
                             "x",
                             "[]",
                             "{}",
                             R"({"type":"unknown"})",
                             R"({"type":"camera","serial":1})",
                             R"({"type":"ack","picture":9})",
                             R"({"type":"watch","load":"yes","tiles":false})",
                             kHello.dump(),
                             R"({"type":"drive"} trailing)"};
  for (const std::string& text : bad) {
    const Incoming end = closed_after(text);
    EXPECT_EQ(end.close_code, kPolicy) << text;
    EXPECT_FALSE(end.close_reason.empty()) << text;
  }
}

TEST_F(HostileTest, BinaryMessagesCloseWithPolicy) {
  Page page = enter();
  page.send_binary("GTRG");
  EXPECT_EQ(page.closed().close_code, kPolicy);
}

TEST_F(HostileTest, JsonBombsAreNotParsed) {
  EXPECT_EQ(closed_after(std::string(500'000, '[')).close_reason, "message is nested too deeply");
  std::string objects;
  for (int i = 0; i < 100'000; ++i) objects += R"({"a":)";
  EXPECT_EQ(closed_after(objects).close_reason, "message is nested too deeply");
}

TEST_F(HostileTest, AWideMessageIsJustAnUnknownOne) {
  std::string wide = R"({"type":"x","a":[0)";
  while (wide.size() < page::kMaxMessageBytes - 10) wide += ",0";
  EXPECT_EQ(closed_after(wide + "]}").close_reason, "type is unknown");
}

TEST_F(HostileTest, APageThatChangesItsMindWithoutEndFillsNothing) {
  Page page = enter();
  page.expect("welcome");
  for (int i = 0; i < 20'000; ++i)
    page.send({{"type", "watch"}, {"load", i % 2 == 0}, {"tiles", i % 3 == 0}});
  page.send({{"type", "ping"}, {"time", 1}});
  EXPECT_EQ(page.expect("pong").at("time"), 1);
  EXPECT_LE(gateway_.take_events().size(), 1U) << "an audience is a state";
}

TEST_F(HostileTest, AGiantMessageIsNotTaken) {
  EXPECT_NE(closed_after(std::string(page::kMaxMessageBytes + 1, ' ')).close_code, 1000);
  Page page = enter();
  // A masked text frame that announces 2^62 bytes.
  page.send_raw(std::string("\x81\xff\x40\0\0\0\0\0\0\0", 10) + "mask");
  EXPECT_NE(page.closed().close_code, 1000);
}

TEST_F(HostileTest, InvalidUtf8IsNotTaken) {
  for (const char* text : {"\xff", "{\"type\":\"\xc3\x28\"}", "\xed\xa0\x80", "\xf4\x90\x80\x80"}) {
    EXPECT_NE(closed_after(text).close_code, 1000);
  }
}

TEST_F(HostileTest, RandomBytesInsteadOfFramesEndThatConnection) {
  std::mt19937 random(7);
  for (int round = 0; round < 50; ++round) {
    Page page = enter();
    std::string bytes(1 + random() % 2000, '\0');
    for (char& c : bytes) c = static_cast<char>(random());
    bytes[0] = static_cast<char>(bytes[0] | 0x70);  // reserved bits: never a frame
    page.send_raw(bytes);
    EXPECT_NE(page.closed().close_code, 1000);
  }
}

TEST_F(HostileTest, RandomBytesInsteadOfHttpEndThatConnection) {
  std::mt19937 random(8);
  for (int round = 0; round < 50; ++round) {
    std::string bytes(1 + random() % 4000, '\0');
    for (char& c : bytes) c = static_cast<char>(random());
    const unsigned status = status_of(exchange(gateway_.port(), "\x01" + bytes + "\r\n\r\n"));
    EXPECT_TRUE(status == 400 || status == 0) << status;
  }
}

TEST_F(HostileTest, AnEndlessHeaderIsCut) {
  const std::string head = "GET / HTTP/1.1\r\nHost: localhost\r\nX: ";
  EXPECT_EQ(status_of(exchange(gateway_.port(), head + std::string(1 << 20, 'x'))), 400U);
}

TEST_F(HostileTest, TruncatedFramesAreNothing) {
  const std::string frame("\x81\x85mask\x25\x04\x1f\x07\x02", 11);
  for (std::size_t length = 1; length < frame.size(); ++length) {
    Page page = enter();
    page.send_raw(frame.substr(0, length));
  }
}

TEST_F(HostileTest, EditsThatNobodyTakesAreLimited) {
  Page page = enter();
  std::uint32_t serial = 0;
  try {
    for (std::size_t i = 0; i < 2 * EventQueue::kMaxEdits; ++i) {
      page.send({{"type", "edit"}, {"serial", ++serial}, {"edit", Json::object()}});
    }
  } catch (const boost::system::system_error&) {
    // The gateway closed while we were writing.
  }
  const Incoming end = page.closed();
  EXPECT_TRUE(end.close_code == kPolicy || end.close_code == 0);
  std::size_t edits = 0;
  for (const GatewayEvent& event : gateway_.take_events()) {
    edits += std::holds_alternative<EditInput>(event);
  }
  EXPECT_EQ(edits, EventQueue::kMaxEdits);
}

class FewConnections : public HostileTest {
 protected:
  FewConnections() : HostileTest(limits()) {}
  static GatewayLimits limits() {
    GatewayLimits limits;
    limits.max_connections = 20;
    limits.handshake = std::chrono::milliseconds(300);
    return limits;
  }
};

TEST_F(FewConnections, AThousandConnectionsAreTooMany) {
  boost::asio::io_context io;
  std::list<tcp::socket> sockets;
  std::size_t refused = 0;
  for (int i = 0; i < 1000; ++i) {
    // Silent ones: those that are let in are cut off when their time is up.
    tcp::socket& socket = sockets.emplace_back(io);
    socket.connect({boost::asio::ip::address_v4::loopback(), gateway_.port()});
    if (sockets.size() > 200) sockets.pop_front();
  }
  for (tcp::socket& socket : sockets) {
    std::array<char, 256> bytes{};
    boost::system::error_code error;
    const std::size_t got = socket.read_some(boost::asio::buffer(bytes), error);
    if (got > 0) {
      EXPECT_EQ(status_of({bytes.data(), got}), 503U);
      ++refused;
    }
  }
  EXPECT_GE(refused, 200U - 2 * 20U);
}

TEST_F(FewConnections, ASlowHandshakeIsCutOff) {
  EXPECT_EQ(exchange(gateway_.port(), "GET / HTTP/1.1\r\nHost: local"), "");
}

TEST_F(FewConnections, APageWithoutHelloIsCutOff) {
  Page page(gateway_.port(), kSession);
  EXPECT_EQ(page.closed().kind, Incoming::Kind::kClosed);
}

class ShortPatience : public HostileTest {
 protected:
  ShortPatience() : HostileTest(limits()) {}
  static GatewayLimits limits() {
    GatewayLimits limits;
    limits.stalled = std::chrono::milliseconds(3000);
    return limits;
  }
  static Picture picture_of(std::size_t bytes) {
    Picture picture;
    picture.size = {64, 64};
    picture.regions.push_back({{0, 0, 64, 64}, 1, std::vector<std::byte>(bytes)});
    return picture;
  }
  static Picture large_picture() { return picture_of(16 << 20); }
  void TearDown() override {
    gateway_.publish(picture_of(1));  // else the good page starts with the large one
    HostileTest::TearDown();
  }
  void wait_for_audience(std::uint32_t viewers) {
    events_until(gateway_, some<AudienceChange>([=](const AudienceChange& change) {
                   return change.viewers == viewers;
                 }));
  }
};

TEST_F(ShortPatience, APageThatStopsReadingIsClosedAndTheOthersGoOn) {
  Page stuck = enter();
  stuck.expect("welcome");
  Page good = enter();
  good.expect("welcome");
  wait_for_audience(2);
  gateway_.publish(large_picture());  // far more than the sockets' buffers hold
  EXPECT_EQ(good.picture().size(), 1U);
  for (int i = 0; i < 1000; ++i) gateway_.broadcast(R"({"type":"status","epoch":1})");
  const Json left = good.expect("driver");
  EXPECT_EQ(left.at("driver"), 2);
  EXPECT_EQ(left.at("viewers"), 1);
}

TEST_F(ShortPatience, APageThatSendsButDoesNotReadIsClosedToo) {
  Page stuck = enter();
  stuck.expect("welcome");
  wait_for_audience(1);
  gateway_.publish(large_picture());
  EXPECT_THROW(
      {
        for (;;) stuck.send({{"type", "ping"}, {"time", 1}});
      },
      boost::system::system_error);
  wait_for_audience(0);
}

class ShortSilence : public HostileTest {
 protected:
  ShortSilence() : HostileTest(limits()) {}
  static GatewayLimits limits() {
    GatewayLimits limits;
    limits.silent = std::chrono::milliseconds(2000);
    return limits;
  }
};

TEST_F(ShortSilence, APageThatDoesNotAnswerPingsIsClosed) {
  Page silent = enter();
  silent.expect("welcome");  // and reads no more, so answers no ping
  for (const std::uint32_t viewers : {1U, 0U}) {
    events_until(gateway_, some<AudienceChange>([=](const AudienceChange& change) {
                   return change.viewers == viewers;
                 }));
  }
}

}  // namespace
}  // namespace goldthread
