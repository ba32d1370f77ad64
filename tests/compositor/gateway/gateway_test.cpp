// SPDX-License-Identifier: Apache-2.0
#include "compositor/gateway/gateway.h"

#include <gtest/gtest.h>

#include <boost/asio/ip/tcp.hpp>
#include <stdexcept>
#include <string>
#include <thread>

#include "client.h"
#include "common/base/result.h"

namespace goldthread {
namespace {

using namespace testing_client;
using Json = nlohmann::json;

constexpr const char* kSession = "/session?token=secret";
const Json kHello{{"type", "hello"}, {"protocol", 2}};

GatewayOptions options() {
  GatewayOptions options;
  options.port = 0;
  options.token = "secret";
  return options;
}

Picture picture_of(std::size_t regions, std::size_t bytes = 100) {
  Picture picture;
  picture.epoch = {5};
  picture.viewer = 1;
  picture.serial = 3;
  picture.size = {320, 200};
  picture.estimated_error = 0.5F;
  for (std::size_t i = 0; i < regions; ++i) {
    const auto row = static_cast<std::int32_t>(i);
    picture.regions.push_back(
        {{0, row, 320, 1}, 1, std::vector<std::byte>(bytes, static_cast<std::byte>(i))});
  }
  return picture;
}

Json ack(std::uint32_t picture) { return {{"type", "ack"}, {"picture", picture}}; }
Json camera(std::uint32_t serial) {
  return {{"type", "camera"},
          {"serial", serial},
          {"camera",
           {{"position", {0, 0, serial}}, {"target", {0, 0, 0}}, {"up", {0, 1, 0}}, {"fovy", 30}}}};
}

class GatewayTest : public testing::Test {
 protected:
  Page enter() {
    Page page(gateway_.port(), kSession);
    page.send(kHello);
    return page;
  }
  void set_welcome() { gateway_.set_welcome(R"({"type":"welcome","protocol":2})"); }

  Gateway gateway_{options()};
};

// ---- binding

TEST_F(GatewayTest, PortZeroFindsAFreeOne) { EXPECT_NE(gateway_.port(), 0); }

TEST_F(GatewayTest, APortInUseIsOneClearLine) {
  GatewayOptions same = options();
  same.port = gateway_.port();
  try {
    Gateway second(same);
    FAIL() << "it was bound twice";
  } catch (const FatalError& error) {
    EXPECT_EQ(error.failure().where, "--port " + std::to_string(same.port));
    EXPECT_EQ(error.failure().what, "address already in use");
    EXPECT_EQ(error.failure().mend, "choose another with --port, or --port 0 for any free one");
    EXPECT_EQ(error.failure().status, ExitStatus::kClusterFailed);
  }
}

TEST(GatewayBind, AHostThatIsNotHereIsOneClearLine) {
  for (const char* host : {"no-such-host.invalid", "192.0.2.1"}) {
    GatewayOptions elsewhere = options();
    elsewhere.host = host;
    try {
      Gateway gateway(elsewhere);
      FAIL() << host << " was bound";
    } catch (const FatalError& error) {
      EXPECT_EQ(error.failure().where, std::string("--host ") + host);
      EXPECT_EQ(error.failure().status, ExitStatus::kClusterFailed);
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
  }
}

TEST(GatewayBind, AnEmptyTokenIsRefused) {
  GatewayOptions open = options();
  open.token = "";
  EXPECT_THROW(Gateway{open}, FatalError);
}

// ---- the page's files

TEST_F(GatewayTest, ThePageComesWithItsSecurityHeaders) {
  const std::string response = exchange(gateway_.port(), request("GET", "/", gateway_.port()));
  EXPECT_EQ(status_of(response), 200U);
  EXPECT_NE(response.find("Content-Security-Policy: default-src 'none'"), std::string::npos);
  EXPECT_NE(response.find("X-Content-Type-Options: nosniff"), std::string::npos);
  EXPECT_NE(response.find("<html"), std::string::npos);
}

TEST_F(GatewayTest, HeadTellsTheLengthWithoutABody) {
  const std::string get = exchange(gateway_.port(), request("GET", "/", gateway_.port()));
  const std::string head = exchange(gateway_.port(), request("HEAD", "/", gateway_.port()));
  const std::size_t body = get.find("\r\n\r\n") + 4;
  EXPECT_EQ(head, get.substr(0, body));
  EXPECT_NE(head.find("Content-Length: " + std::to_string(get.size() - body)), std::string::npos);
}

TEST_F(GatewayTest, AConnectionServesSeveralRequests) {
  const std::string first =
      "GET /nothing HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(gateway_.port()) + "\r\n\r\n";
  const std::string response =
      exchange(gateway_.port(), first + first + request("GET", "/", gateway_.port()));
  EXPECT_EQ(status_of(response), 404U);
  const std::size_t second = response.find("HTTP/1.1 ", 1);
  ASSERT_NE(second, std::string::npos);
  EXPECT_EQ(status_of(response.substr(second)), 404U);
  const std::size_t third = response.find("HTTP/1.1 ", second + 1);
  ASSERT_NE(third, std::string::npos);
  EXPECT_EQ(status_of(response.substr(third)), 200U);
}

TEST_F(GatewayTest, WhatIsNotAPageIsToldSo) {
  const auto status = [&](const std::string& bytes) {
    return status_of(exchange(gateway_.port(), bytes));
  };
  const std::uint16_t port = gateway_.port();
  EXPECT_EQ(status(request("GET", "/nothing", port)), 404U);
  EXPECT_EQ(status(request("GET", "/../../etc/passwd", port)), 404U);
  EXPECT_EQ(status(request("GET", "/%2e%2e/%2e%2e/etc/passwd", port)), 404U);
  EXPECT_EQ(status(request("POST", "/", port, "Content-Length: 3\r\n") + "abc"), 405U);
  EXPECT_EQ(status(request("GET", "/", port, "Content-Length: 3\r\n") + "abc"), 400U);
  EXPECT_EQ(status(request("GET", "/session?token=secret", port)), 426U);
  EXPECT_EQ(status(request("GET", "/session?token=wrong", port)), 403U);
  EXPECT_EQ(status("GET / HTTP/1.1\r\nConnection: close\r\nHost: evil.example\r\n\r\n"), 403U);
  EXPECT_EQ(status("GET / HTTP/1.1\r\nConnection: close\r\n\r\n"), 400U);
  EXPECT_EQ(status("nonsense\r\n\r\n"), 400U);
}

// ---- the session

TEST_F(GatewayTest, OnlyTheRightTokenOpensASession) {
  EXPECT_NO_THROW(Page(gateway_.port(), kSession));
  for (const char* target : {"/session", "/session?token=", "/session?token=secres",
                             "/session?token=secret&token=secret", "/other?token=secret"}) {
    EXPECT_THROW(Page(gateway_.port(), target), boost::system::system_error) << target;
  }
}

TEST_F(GatewayTest, OnlyOurOwnPageMayOpenASession) {
  const std::string ours = "http://127.0.0.1:" + std::to_string(gateway_.port());
  EXPECT_NO_THROW(Page(gateway_.port(), kSession, ours));
  EXPECT_THROW(Page(gateway_.port(), kSession, "http://evil.example"), boost::system::system_error);
  EXPECT_THROW(Page(gateway_.port(), kSession, "null"), boost::system::system_error);
}

TEST_F(GatewayTest, LoadingComesBeforeTheWelcome) {
  Page page = enter();
  EXPECT_EQ(page.receive().json.at("type"), "loading");
  gateway_.broadcast(R"({"type":"loading","what":"head","done":1,"total":2})");
  EXPECT_EQ(page.receive().json.at("what"), "head");
  set_welcome();
  EXPECT_EQ(
      page.receive().json,
      (Json{{"type", "welcome"}, {"protocol", 2}, {"viewer", 1}, {"driver", 1}, {"viewers", 1}}));
}

TEST_F(GatewayTest, TwoPagesShareASessionAndHandItOn) {
  set_welcome();
  std::optional<Page> first(std::in_place, gateway_.port(), kSession);
  first->send(kHello);
  EXPECT_EQ(first->expect("welcome").at("driver"), 1);
  Page second = enter();
  EXPECT_EQ(second.expect("welcome").at("driver"), 1);
  EXPECT_EQ(first->expect("driver").at("viewers"), 2);

  second.send(camera(1));  // ignored
  second.send({{"type", "drive"}});
  EXPECT_EQ(first->expect("driver").at("driver"), 2);
  EXPECT_EQ(second.expect("driver").at("driver"), 2);
  second.send(camera(2));
  const auto seen = events_until(
      gateway_, some<CameraInput>([](const CameraInput& input) { return input.serial == 2; }));
  for (const GatewayEvent& event : seen) {
    if (const auto* input = std::get_if<CameraInput>(&event)) {
      EXPECT_EQ(input->viewer, 2U);
      EXPECT_EQ(input->serial, 2U);
      EXPECT_EQ(input->camera.position.z, 2);
    }
  }
  first->send({{"type", "drive"}});
  EXPECT_EQ(second.expect("driver").at("driver"), 1);
  first.reset();  // without a word
  const Json left = second.expect("driver");
  EXPECT_EQ(left.at("driver"), 2);
  EXPECT_EQ(left.at("viewers"), 1);
}

TEST_F(GatewayTest, EditsSizesAndDisplaySettingsComeThroughInOrder) {
  set_welcome();
  Page page = enter();
  page.send({{"type", "edit"}, {"serial", 1}, {"edit", {{"step", 0.5}}}});
  page.send({{"type", "size"}, {"serial", 2}, {"width", 640}, {"height", 480}});
  page.send({{"type", "display"},
             {"serial", 3},
             {"filter", "box"},
             {"update", "frameless"},
             {"cine", false}});
  page.send({{"type", "edit"}, {"serial", 4}, {"edit", {{"lights", Json::array()}}}});
  const auto events = events_until(
      gateway_, some<EditInput>([](const EditInput& input) { return input.serial == 4; }));
  std::vector<std::uint32_t> serials;
  for (const GatewayEvent& event : events) {
    if (const auto* edit = std::get_if<EditInput>(&event)) serials.push_back(edit->serial);
    if (const auto* size = std::get_if<SizeInput>(&event)) {
      serials.push_back(size->serial);
      EXPECT_EQ(size->size, (ImageSize{640, 480}));
    }
    if (const auto* display = std::get_if<DisplayInput>(&event)) {
      serials.push_back(display->serial);
      EXPECT_EQ(display->display, (DisplaySettings{Filter::kBox, Update::kFrameless, false}));
    }
  }
  EXPECT_EQ(serials, (std::vector<std::uint32_t>{1, 2, 3, 4}));
}

TEST_F(GatewayTest, RegionsArriveToTheByte) {
  set_welcome();
  Page page = enter();
  page.expect("welcome");
  gateway_.publish(picture_of(3));
  const auto regions = page.picture();
  ASSERT_EQ(regions.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    const Picture original = picture_of(3);
    RegionHeader expected = region_header(original, i, 1);
    ASSERT_EQ(regions[i].bytes.size(), kRegionHeaderBytes + 100);
    const RegionHeaderBytes header = encode(expected);
    EXPECT_TRUE(std::equal(header.begin(), header.end(), regions[i].bytes.begin()));
    EXPECT_TRUE(std::equal(original.regions[i].payload.begin(), original.regions[i].payload.end(),
                           regions[i].bytes.begin() + kRegionHeaderBytes));
  }
}

TEST_F(GatewayTest, ALargeRegionIsOneMessage) {
  set_welcome();
  Page page = enter();
  page.expect("welcome");
  gateway_.publish(picture_of(1, 20 << 20));
  EXPECT_EQ(page.picture().at(0).bytes.size(), kRegionHeaderBytes + (20 << 20));
}

TEST_F(GatewayTest, APageThatDoesNotAcknowledgeGetsTwoPicturesAndThenTheNewest) {
  set_welcome();
  Page page = enter();
  page.expect("welcome");
  for (std::uint32_t i = 1; i <= 2; ++i) {
    gateway_.publish(picture_of(2));
    EXPECT_EQ(page.picture()[0].header.picture, i);
  }
  for (int i = 3; i <= 50; ++i) gateway_.publish(picture_of(2));
  gateway_.send(1, R"({"type":"refused","serial":1})");
  EXPECT_EQ(page.receive().kind, Incoming::Kind::kText) << "a third picture came";
  page.send(ack(2));
  EXPECT_EQ(page.picture()[0].header.picture, 50U);
}

TEST_F(GatewayTest, TheAudienceChangesWithPagesAndTheirRoom) {
  const auto is = [](std::uint32_t viewers, bool ready) {
    return some<AudienceChange>([=](const AudienceChange& change) {
      return change.viewers == viewers && change.ready == ready;
    });
  };
  set_welcome();
  {
    Page page = enter();
    page.expect("welcome");
    events_until(gateway_, is(1, true));
    gateway_.publish(picture_of(1));
    page.picture();
    gateway_.publish(picture_of(1));
    page.picture();
    events_until(gateway_, is(1, false));
    page.send(ack(1));
    events_until(gateway_, is(1, true));
  }
  events_until(gateway_, is(0, false));
}

TEST_F(GatewayTest, ALaterPageStartsWithTheNewestPicture) {
  set_welcome();
  gateway_.publish(picture_of(1));
  gateway_.publish(picture_of(1));
  Page page = enter();
  EXPECT_EQ(page.picture()[0].header.picture, 2U);
}

TEST_F(GatewayTest, OurOwnBugsAreThrownWhereTheyAre) {
  EXPECT_THROW(gateway_.publish({}), std::invalid_argument);
  EXPECT_THROW(gateway_.broadcast("{"), std::invalid_argument);
  EXPECT_THROW(gateway_.set_welcome("[]"), std::invalid_argument);
  EXPECT_THROW(gateway_.send(1, "{}"), std::invalid_argument);
  EXPECT_NO_THROW(gateway_.send(99, R"({"type":"refused"})"));
}

TEST_F(GatewayTest, ItsMethodsMayBeCalledFromManyThreads) {
  set_welcome();
  Page page = enter();
  page.expect("welcome");
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([this] {
      for (int i = 0; i < 100; ++i) {
        gateway_.publish(picture_of(2));
        gateway_.broadcast(R"({"type":"status","epoch":1})");
        gateway_.take_events();
      }
    });
  }
  std::uint32_t shown = 0;
  while (shown < 400) {
    shown = page.picture()[0].header.picture;
    page.send(ack(shown));
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(shown, 400U);
}

TEST(GatewayEnd, PagesAreToldThatTheServerEnds) {
  std::optional<Gateway> gateway(std::in_place, options());
  gateway->set_welcome(R"({"type":"welcome"})");
  Page page(gateway->port(), kSession);
  page.send(kHello);
  page.expect("welcome");
  std::thread ending([&] { gateway.reset(); });
  const Incoming last = page.closed();
  ending.join();
  EXPECT_EQ(last.close_code, 1001);
  EXPECT_EQ(last.close_reason, "the server ends");
}

TEST(GatewayEnd, APageThatDoesNotAnswerHoldsNothingUp) {
  std::optional<Gateway> gateway(std::in_place, options());
  Page page(gateway->port(), kSession);
  page.send(kHello);
  page.expect("loading");
  const auto start = std::chrono::steady_clock::now();
  gateway.reset();
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
}

}  // namespace
}  // namespace goldthread
