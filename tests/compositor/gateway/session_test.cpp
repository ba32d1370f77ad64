// SPDX-License-Identifier: Apache-2.0
#include "compositor/gateway/session.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <random>
#include <stdexcept>

namespace goldthread {
namespace {

using Json = nlohmann::json;

constexpr const char* kHello = R"({"type":"hello","protocol":2})";

Picture picture_of(std::size_t regions, std::uint32_t epoch = 1) {
  Picture picture;
  picture.epoch = {epoch};
  picture.size = {64, 64};
  picture.regions.assign(regions, {{0, 0, 64, 64}, 1, {std::byte{7}}});
  return picture;
}

Picture cine_frame(std::uint8_t frame, ImageSize size = {64, 64}) {
  Picture picture = picture_of(2);
  picture.cine_frame = frame;
  picture.cine_frames = 7;
  picture.size = size;
  return picture;
}

std::string camera(std::uint32_t serial) {
  return R"({"type":"camera","camera":{"position":[0,0,9],"target":[0,0,0],"up":[0,1,0],"fovy":30},"serial":)" +
         std::to_string(serial) + "}";
}
std::string ack(std::uint32_t picture) {
  return R"({"type":"ack","picture":)" + std::to_string(picture) + "}";
}
std::string edit(std::uint32_t serial) {
  return R"({"type":"edit","edit":{"step":1},"serial":)" + std::to_string(serial) + "}";
}

class SessionTest : public testing::Test {
 protected:
  Viewer enter() {
    const Viewer viewer = session_.open();
    session_.receive_text(viewer, kHello);
    return viewer;
  }
  void set_welcome() { session_.set_welcome(R"({"type":"welcome","protocol":2})"); }

  std::vector<Frame> drain(Viewer viewer) {
    std::vector<Frame> frames;
    while (auto frame = session_.next_frame(viewer)) frames.push_back(std::move(*frame));
    return frames;
  }
  /// The texts among what waits for a page.
  std::vector<Json> texts(Viewer viewer) {
    std::vector<Json> result;
    for (const Frame& frame : drain(viewer)) {
      if (const auto* text = std::get_if<TextFrame>(&frame)) {
        result.push_back(Json::parse(*text->text));
      }
    }
    return result;
  }
  std::vector<std::string> types(Viewer viewer) {
    std::vector<std::string> result;
    for (const Json& text : texts(viewer)) result.push_back(text.at("type"));
    return result;
  }
  /// Why a page is closed; empty if it is not.
  std::string closed(Viewer viewer, std::uint16_t code = Session::kPolicy) {
    for (const Frame& frame : drain(viewer)) {
      if (const auto* close = std::get_if<CloseFrame>(&frame)) {
        EXPECT_EQ(close->code, code);
        EXPECT_FALSE(close->reason.empty());
        EXPECT_LE(close->reason.size(), 123U);
        return close->reason;
      }
    }
    return "";
  }
  /// The numbers of the pictures that a page gets now, whole ones in order.
  std::vector<std::uint32_t> pictures(Viewer viewer) {
    std::vector<std::uint32_t> result;
    std::size_t next = 0;
    for (const Frame& frame : drain(viewer)) {
      const auto* region = std::get_if<RegionFrame>(&frame);
      if (!region) continue;
      EXPECT_EQ(region->region, next);
      if (region->region == 0) result.push_back(region->picture->number);
      EXPECT_EQ(region->picture->number, result.back());
      next = next + 1 == region->picture->headers.size() ? 0 : next + 1;
    }
    EXPECT_EQ(next, 0U) << "a picture was not finished";
    return result;
  }
  template <class T>
  std::vector<T> events() {
    std::vector<T> result;
    for (const GatewayEvent& event : session_.take_events()) {
      if (const auto* wanted = std::get_if<T>(&event)) result.push_back(*wanted);
    }
    return result;
  }

  Session session_;
};

// ---- arriving

TEST_F(SessionTest, APageIsToldThatTheVolumeIsLoadingUntilItIsWelcome) {
  const Viewer viewer = enter();
  EXPECT_EQ(types(viewer), std::vector<std::string>{"loading"});
  session_.broadcast(R"({"type":"loading","what":"ch2.nii.gz","done":1,"total":2})");
  EXPECT_EQ(texts(viewer).at(0).at("what"), "ch2.nii.gz");
  const Viewer later = enter();
  EXPECT_EQ(texts(later).at(0).at("what"), "ch2.nii.gz");

  set_welcome();
  const auto welcomed = texts(viewer);
  ASSERT_EQ(welcomed.size(), 1U);
  EXPECT_EQ(welcomed[0], (Json{{"type", "welcome"},
                               {"protocol", 2},
                               {"viewer", viewer},
                               {"driver", viewer},
                               {"viewers", 2}}));
  EXPECT_EQ(texts(later).at(0).at("viewer"), later);
}

TEST_F(SessionTest, AWelcomeOvertakesWhatWasToBeSaidAboutLoading) {
  const Viewer viewer = enter();
  session_.broadcast(R"({"type":"loading","done":1})");
  set_welcome();
  session_.broadcast(R"({"type":"view","width":1})");
  EXPECT_EQ(types(viewer), (std::vector<std::string>{"welcome", "view"}));
}

TEST_F(SessionTest, ALaterPageIsToldWhatChangedSinceTheWelcomeWasSet) {
  set_welcome();
  session_.broadcast(R"({"type":"view","width":1})");
  session_.broadcast(R"({"type":"status","epoch":1})");
  session_.broadcast(R"({"type":"view","width":2})");
  const auto said = texts(enter());
  ASSERT_EQ(said.size(), 3U);
  EXPECT_EQ(said[0].at("type"), "welcome");
  EXPECT_EQ(said[1].at("width"), 2);
  EXPECT_EQ(said[2].at("type"), "status");
  set_welcome();
  EXPECT_EQ(types(enter()), std::vector<std::string>{"welcome"});
}

TEST_F(SessionTest, ASecondWelcomeIsForLaterPagesOnly) {
  set_welcome();
  const Viewer viewer = enter();
  texts(viewer);
  session_.set_welcome(R"({"type":"welcome","protocol":2,"scene":2})");
  EXPECT_TRUE(texts(viewer).empty());
  const Viewer later = enter();
  EXPECT_EQ(texts(later).at(0).at("scene"), 2);
}

TEST_F(SessionTest, TheGatewaysNumbersReplaceThoseInAWelcome) {
  session_.set_welcome(R"({"type":"welcome","viewer":99,"driver":99,"viewers":99})");
  const Viewer viewer = enter();
  EXPECT_EQ(texts(viewer).at(0),
            (Json{{"type", "welcome"}, {"viewer", viewer}, {"driver", viewer}, {"viewers", 1}}));
}

TEST_F(SessionTest, HelloComesFirstAndOnce) {
  const Viewer rude = session_.open();
  session_.receive_text(rude, R"({"type":"drive"})");
  EXPECT_EQ(closed(rude), "hello must come first");
  const Viewer twice = enter();
  session_.receive_text(twice, kHello);
  EXPECT_EQ(closed(twice), "hello comes once");
}

TEST_F(SessionTest, AnotherProtocolIsRefusedWithItsNumberAndClosed) {
  const Viewer viewer = session_.open();
  session_.receive_text(viewer, R"({"type":"hello","protocol":1})");
  const auto frames = drain(viewer);
  ASSERT_EQ(frames.size(), 2U);
  const Json refused = Json::parse(*std::get<TextFrame>(frames[0]).text);
  EXPECT_EQ(refused.at("type"), "refused");
  EXPECT_EQ(refused.at("serial"), 0);
  EXPECT_EQ(std::get<CloseFrame>(frames[1]).code, Session::kPolicy);
  EXPECT_TRUE(events<AudienceChange>().empty());
}

TEST_F(SessionTest, AMalformedMessageClosesWithTheReason) {
  const Viewer viewer = enter();
  session_.receive_text(viewer, R"({"type":"ack","picture":"1"})");
  EXPECT_EQ(closed(viewer), "picture is not an integer");
  const Viewer binary = enter();
  session_.receive_binary(binary);
  EXPECT_EQ(closed(binary), "pages send no binary messages");
}

TEST_F(SessionTest, AClosedPageIsNeitherHeardNorTold) {
  set_welcome();
  const Viewer viewer = enter();
  const Viewer other = enter();
  session_.close(viewer, Session::kPolicy, "test");
  session_.receive_text(viewer, camera(1));
  session_.receive_text(viewer, R"({"type":"drive"})");
  session_.broadcast(R"({"type":"view"})");
  session_.send(viewer, R"({"type":"refused"})");
  session_.publish(picture_of(1));
  const auto frames = drain(viewer);
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_TRUE(std::holds_alternative<CloseFrame>(frames[0]));
  EXPECT_TRUE(events<CameraInput>().empty());
  EXPECT_EQ(texts(other).back().at("type"), "view");
  session_.gone(viewer);
  session_.gone(viewer);
  EXPECT_FALSE(session_.next_frame(viewer).has_value());
}

// ---- driving

TEST_F(SessionTest, TheFirstPageDrivesAndTheOthersWatch) {
  set_welcome();
  const Viewer first = enter();
  const Viewer second = enter();
  EXPECT_EQ(texts(second).at(0).at("driver"), first);
  const auto told = texts(first);
  EXPECT_EQ(told.back(), (Json{{"type", "driver"}, {"driver", first}, {"viewers", 2}}));

  session_.receive_text(second, camera(1));
  EXPECT_TRUE(events<CameraInput>().empty());
  session_.receive_text(first, camera(1));
  const auto inputs = events<CameraInput>();
  ASSERT_EQ(inputs.size(), 1U);
  EXPECT_EQ(inputs[0].viewer, first);
  EXPECT_EQ(inputs[0].camera, (Camera{{0, 0, 9}, {0, 0, 0}, {0, 1, 0}, 30}));
}

TEST_F(SessionTest, APageMayTakeOver) {
  set_welcome();
  const Viewer first = enter();
  const Viewer second = enter();
  texts(first);
  texts(second);
  session_.receive_text(second, R"({"type":"drive"})");
  const Json expected{{"type", "driver"}, {"driver", second}, {"viewers", 2}};
  EXPECT_EQ(texts(first), std::vector<Json>{expected});
  EXPECT_EQ(texts(second), std::vector<Json>{expected});
  session_.receive_text(first, edit(1));
  session_.receive_text(second, edit(1));
  const auto inputs = events<EditInput>();
  ASSERT_EQ(inputs.size(), 1U);
  EXPECT_EQ(inputs[0].viewer, second);
  EXPECT_EQ(inputs[0].edit_json, R"({"step":1})");
  session_.receive_text(second, R"({"type":"drive"})");
  EXPECT_TRUE(texts(first).empty());
}

TEST_F(SessionTest, WhenTheDriverLeavesTheLongestConnectedPageDrives) {
  set_welcome();
  const Viewer a = enter();
  const Viewer b = enter();
  const Viewer c = enter();
  session_.receive_text(c, R"({"type":"drive"})");
  for (const Viewer viewer : {a, b, c}) texts(viewer);
  session_.gone(c);
  EXPECT_EQ(texts(b).back(), (Json{{"type", "driver"}, {"driver", a}, {"viewers", 2}}));
  session_.close(a, Session::kPolicy, "test");
  EXPECT_EQ(texts(b).back(), (Json{{"type", "driver"}, {"driver", b}, {"viewers", 1}}));
  session_.gone(b);
  const Viewer d = enter();
  EXPECT_EQ(texts(d).at(0).at("driver"), d);
}

TEST_F(SessionTest, AConnectionWithoutHelloNeverDrives) {
  set_welcome();
  const Viewer silent = session_.open();
  const Viewer page = enter();
  EXPECT_EQ(texts(page).at(0).at("driver"), page);
  EXPECT_EQ(events<AudienceChange>().at(0).viewers, 1U);
  session_.gone(page);
  EXPECT_TRUE(drain(silent).empty());
  EXPECT_EQ(events<AudienceChange>().at(0).viewers, 0U);
}

TEST_F(SessionTest, SerialsGrowWhetherOrNotThePageDrives) {
  const Viewer first = enter();
  const Viewer second = enter();
  session_.receive_text(first, camera(1));
  session_.receive_text(first, edit(2));
  session_.receive_text(first, edit(2));
  EXPECT_EQ(closed(first), "serial does not grow");
  session_.receive_text(second, camera(5));
  session_.receive_text(second, camera(4));
  EXPECT_EQ(closed(second), "serial does not grow");
}

TEST_F(SessionTest, ValuesOutOfRangeAreRefusedAndThePageStays) {
  set_welcome();
  const Viewer viewer = enter();
  texts(viewer);
  session_.receive_text(viewer, R"({"type":"size","serial":1,"width":15,"height":512})");
  const auto refused = texts(viewer);
  ASSERT_EQ(refused.size(), 1U);
  EXPECT_EQ(refused[0].at("type"), "refused");
  EXPECT_EQ(refused[0].at("serial"), 1);
  EXPECT_TRUE(events<SizeInput>().empty());
  session_.receive_text(viewer, R"({"type":"size","serial":2,"width":16,"height":4096})");
  const auto sizes = events<SizeInput>();
  ASSERT_EQ(sizes.size(), 1U);
  EXPECT_EQ(sizes[0].size, (ImageSize{16, 4096}));
  EXPECT_EQ(sizes[0].serial, 2U);
}

TEST_F(SessionTest, TheDriverChoosesHowItIsDisplayed) {
  set_welcome();
  const Viewer driver = enter();
  const Viewer watcher = enter();
  const auto display = [](std::uint32_t serial, const std::string& filter) {
    return R"({"type":"display","filter":")" + filter + R"(","update":"25","cine":true,"serial":)" +
           std::to_string(serial) + "}";
  };
  texts(driver);
  session_.receive_text(watcher, display(1, "box"));
  session_.receive_text(driver, display(1, "bicubic"));
  session_.receive_text(driver, display(2, "sinc"));
  const auto inputs = events<DisplayInput>();
  ASSERT_EQ(inputs.size(), 1U);
  EXPECT_EQ(inputs[0].viewer, driver);
  EXPECT_EQ(inputs[0].serial, 1U);
  EXPECT_EQ(inputs[0].display, (DisplaySettings{Filter::kBicubic, Update::kQuarter, true}));
  const auto refused = texts(driver);
  ASSERT_EQ(refused.size(), 1U);
  EXPECT_EQ(refused[0].at("type"), "refused");
  EXPECT_EQ(refused[0].at("where"), "display.filter");
  EXPECT_EQ(refused[0].at("serial"), 2);
}

TEST_F(SessionTest, APingIsAnsweredWithItsTime) {
  const Viewer viewer = enter();
  texts(viewer);
  session_.receive_text(viewer, R"({"type":"ping","time":1234567.125})");
  EXPECT_EQ(texts(viewer), (std::vector<Json>{{{"type", "pong"}, {"time", 1234567.125}}}));
}

// ---- pictures

TEST_F(SessionTest, AtMostTwoPicturesAreUnacknowledgedAndTheNewestWins) {
  set_welcome();
  const Viewer viewer = enter();
  drain(viewer);
  std::vector<std::uint32_t> sent;
  for (int i = 0; i < 10; ++i) {
    session_.publish(picture_of(3));
    for (const auto number : pictures(viewer)) sent.push_back(number);
  }
  EXPECT_EQ(sent, (std::vector<std::uint32_t>{1, 2}));
  session_.receive_text(viewer, ack(1));
  EXPECT_EQ(pictures(viewer), std::vector<std::uint32_t>{10});
  session_.receive_text(viewer, ack(10));
  EXPECT_TRUE(pictures(viewer).empty());
}

TEST_F(SessionTest, AnAckCoversOlderPictures) {
  set_welcome();
  const Viewer viewer = enter();
  drain(viewer);
  session_.publish(picture_of(1));
  EXPECT_EQ(pictures(viewer).size(), 1U);
  session_.publish(picture_of(1));
  EXPECT_EQ(pictures(viewer).size(), 1U);
  session_.receive_text(viewer, ack(2));
  for (int i = 0; i < 2; ++i) {
    session_.publish(picture_of(1));
    EXPECT_EQ(pictures(viewer).size(), 1U);
  }
  session_.publish(picture_of(1));
  EXPECT_TRUE(pictures(viewer).empty());
}

TEST_F(SessionTest, AnOldAckChangesNothingAndAnAckOfTheFutureCloses) {
  set_welcome();
  const Viewer viewer = enter();
  drain(viewer);
  for (int i = 0; i < 3; ++i) {
    session_.publish(picture_of(1));
    drain(viewer);
  }
  session_.receive_text(viewer, ack(2));
  EXPECT_EQ(pictures(viewer).size(), 1U);
  session_.publish(picture_of(1));
  EXPECT_EQ(pictures(viewer).size(), 1U);
  session_.publish(picture_of(1));
  session_.receive_text(viewer, ack(1));
  session_.receive_text(viewer, ack(2));
  EXPECT_TRUE(pictures(viewer).empty());
  session_.receive_text(viewer, ack(5));
  EXPECT_EQ(closed(viewer), "ack of a picture that was never sent");
}

TEST_F(SessionTest, APictureThatWasBegunIsFinishedBeforeTheNextOne) {
  set_welcome();
  const Viewer viewer = enter();
  drain(viewer);
  session_.publish(picture_of(3));
  std::vector<std::pair<std::uint32_t, std::size_t>> order;
  for (int i = 0; i < 6; ++i) {
    session_.publish(picture_of(3));  // newer ones come all the time
    const auto frame = session_.next_frame(viewer);
    ASSERT_TRUE(frame.has_value());
    const auto& region = std::get<RegionFrame>(*frame);
    order.emplace_back(region.picture->number, region.region);
  }
  EXPECT_EQ(order, (std::vector<std::pair<std::uint32_t, std::size_t>>{
                       {2, 0}, {2, 1}, {2, 2}, {5, 0}, {5, 1}, {5, 2}}));
}

TEST_F(SessionTest, FramesOfACineLoopDoNotOvertakeEachOther) {
  set_welcome();
  const Viewer viewer = enter();
  drain(viewer);
  session_.publish(picture_of(1));
  EXPECT_EQ(pictures(viewer), std::vector<std::uint32_t>{1});
  for (std::uint8_t frame = 1; frame <= 7; ++frame) session_.publish(cine_frame(frame));
  std::vector<std::uint32_t> sent;
  for (bool more = true; more;) {
    const auto now = pictures(viewer);
    more = !now.empty();
    sent.insert(sent.end(), now.begin(), now.end());
    if (more) session_.receive_text(viewer, ack(sent.back()));
  }
  EXPECT_EQ(sent, (std::vector<std::uint32_t>{2, 3, 4, 5, 6, 7, 8}));
  EXPECT_EQ(pictures(enter()), (std::vector<std::uint32_t>{2, 3})) << "a late page gets all, too";
}

TEST_F(SessionTest, ACineFrameIsOvertakenByWhatTakesItsPlace) {
  set_welcome();
  const auto begun = [&] { return pictures(enter()); };
  session_.publish(picture_of(1));
  session_.publish(cine_frame(3));
  EXPECT_EQ(begun(), std::vector<std::uint32_t>{2}) << "a loop ends what was before it";
  session_.publish(cine_frame(4));
  session_.publish(cine_frame(3));
  EXPECT_EQ(begun(), (std::vector<std::uint32_t>{3, 4})) << "the newest of each place";
  session_.publish(cine_frame(5, {65, 64}));
  EXPECT_EQ(begun(), std::vector<std::uint32_t>{5}) << "another size is another loop";
  session_.publish(picture_of(1));
  EXPECT_EQ(begun(), std::vector<std::uint32_t>{6}) << "a picture ends the loop";
}

TEST_F(SessionTest, ALatePageStartsWithTheNewestPicture) {
  set_welcome();
  session_.publish(picture_of(2));
  session_.publish(picture_of(2));
  const Viewer viewer = enter();
  EXPECT_EQ(pictures(viewer), std::vector<std::uint32_t>{2});
}

TEST_F(SessionTest, APageThatWaitsForItsWelcomeGetsNoPicture) {
  const Viewer viewer = enter();
  session_.publish(picture_of(1));
  EXPECT_TRUE(pictures(viewer).empty());
  set_welcome();
  EXPECT_EQ(pictures(viewer), std::vector<std::uint32_t>{1});
}

TEST_F(SessionTest, OnePagesSlownessIsNotAnothers) {
  set_welcome();
  const Viewer slow = enter();
  const Viewer quick = enter();
  drain(slow);
  drain(quick);
  for (std::uint32_t i = 1; i <= 20; ++i) {
    session_.publish(picture_of(2));
    EXPECT_EQ(pictures(quick), std::vector<std::uint32_t>{i});
    session_.receive_text(quick, ack(i));
  }
  EXPECT_EQ(pictures(slow), std::vector<std::uint32_t>{20});
}

TEST_F(SessionTest, HeadersNameThePictureAndItsRegions) {
  set_welcome();
  const Viewer viewer = enter();
  texts(viewer);
  Picture picture = picture_of(2, 77);
  picture.viewer = viewer;
  picture.serial = 9;
  session_.publish(std::move(picture));
  const auto frames = drain(viewer);
  ASSERT_EQ(frames.size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto& region = std::get<RegionFrame>(frames[i]);
    const auto header = decode_region_header(region.picture->headers.at(region.region));
    ASSERT_TRUE(header.ok());
    EXPECT_EQ(header->picture, 1U);
    EXPECT_EQ(header->epoch, 77U);
    EXPECT_EQ(header->serial, 9U);
    EXPECT_EQ(header->index, i);
    EXPECT_EQ(header->count, 2U);
  }
}

// ---- the audience

// ---- watching

constexpr const char* kLoad = R"({"type":"load","bin":50})";
constexpr const char* kTiles = R"({"type":"tiles","epoch":1})";
std::string watch(bool load, bool tiles) {
  return Json{{"type", "watch"}, {"load", load}, {"tiles", tiles}}.dump();
}

TEST_F(SessionTest, OnlyWhoWatchesIsToldWhatIsWatched) {
  set_welcome();
  const Viewer neither = enter(), load = enter(), both = enter();
  session_.receive_text(load, watch(true, false));
  session_.receive_text(both, watch(true, true));
  for (const Viewer viewer : {neither, load, both}) texts(viewer);
  session_.broadcast(kLoad);
  session_.broadcast(kTiles);
  EXPECT_TRUE(types(neither).empty());
  EXPECT_EQ(types(load), std::vector<std::string>{"load"});
  EXPECT_EQ(types(both), (std::vector<std::string>{"load", "tiles"}));
  session_.receive_text(both, watch(false, false));
  session_.broadcast(kLoad);
  EXPECT_EQ(types(load), std::vector<std::string>{"load"});
  EXPECT_TRUE(types(both).empty());
}

TEST_F(SessionTest, WhatIsWatchedIsNotKeptForLaterPages) {
  set_welcome();
  session_.receive_text(enter(), watch(true, true));
  session_.broadcast(kLoad);
  session_.broadcast(kTiles);
  const Viewer later = enter();
  EXPECT_EQ(types(later), std::vector<std::string>{"welcome"});
  session_.receive_text(later, watch(true, true));
  EXPECT_TRUE(types(later).empty());
}

TEST_F(SessionTest, ASlowWatcherGetsTheNewestLoadAlone) {
  set_welcome();
  const Viewer viewer = enter();
  session_.receive_text(viewer, watch(true, false));
  texts(viewer);
  for (int i = 0; i < 10'000; ++i)
    session_.broadcast(R"({"type":"load","bin":)" + std::to_string(i) + "}");
  const auto said = texts(viewer);
  ASSERT_EQ(said.size(), 1U);
  EXPECT_EQ(said[0].at("bin"), 9999);
}

TEST_F(SessionTest, AWatcherNeedNotDriveAndMayWatchBeforeItIsWelcome) {
  const Viewer driver = enter(), viewer = enter();
  session_.receive_text(viewer, watch(true, false));
  session_.broadcast(kLoad);
  EXPECT_EQ(types(viewer), std::vector<std::string>{"loading"});
  set_welcome();
  session_.broadcast(kLoad);
  EXPECT_EQ(types(viewer), (std::vector<std::string>{"welcome", "load"}));
  for (const std::string& type : types(driver)) EXPECT_NE(type, "load");
}

TEST_F(SessionTest, TheAudienceWatchesWhatAnyOfItsPagesDoes) {
  set_welcome();
  const Viewer first = enter(), second = enter();
  EXPECT_EQ(events<AudienceChange>().at(0).watch, Watch{});
  session_.receive_text(first, watch(true, false));
  EXPECT_EQ(events<AudienceChange>().at(0).watch, (Watch{true, false}));
  session_.receive_text(second, watch(true, true));
  EXPECT_EQ(events<AudienceChange>().at(0).watch, (Watch{true, true}));
  session_.receive_text(first, watch(false, false));
  EXPECT_TRUE(events<AudienceChange>().empty()) << "the other watches the same";
  session_.gone(second);
  EXPECT_EQ(events<AudienceChange>().at(0).watch, Watch{});
  session_.receive_text(first, watch(false, true));
  events<AudienceChange>();
  session_.close(first, Session::kPolicy, "test");
  EXPECT_EQ(events<AudienceChange>().at(0).watch, Watch{});
}

TEST_F(SessionTest, TheAudienceIsReadyWhileOnePageHasRoom) {
  const Viewer viewer = enter();
  auto changes = events<AudienceChange>();
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_EQ(changes[0].viewers, 1U);
  EXPECT_FALSE(changes[0].ready) << "it waits for its welcome";
  set_welcome();
  drain(viewer);
  EXPECT_TRUE(events<AudienceChange>().at(0).ready);

  session_.publish(picture_of(1));
  drain(viewer);
  EXPECT_TRUE(events<AudienceChange>().empty()) << "one more has room";
  session_.publish(picture_of(1));
  drain(viewer);
  EXPECT_FALSE(events<AudienceChange>().at(0).ready);
  const Viewer second = enter();
  drain(second);
  changes = events<AudienceChange>();
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_EQ(changes[0].viewers, 2U);
  EXPECT_TRUE(changes[0].ready);
  session_.gone(second);
  EXPECT_FALSE(events<AudienceChange>().at(0).ready);
  session_.receive_text(viewer, ack(1));
  drain(viewer);
  EXPECT_TRUE(events<AudienceChange>().at(0).ready);
  session_.gone(viewer);
  changes = events<AudienceChange>();
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_EQ(changes[0].viewers, 0U);
  EXPECT_FALSE(changes[0].ready);
}

TEST_F(SessionTest, APageThatStillTakesAPictureIsNotReadyForOneInItsSlot) {
  set_welcome();
  const Viewer viewer = enter();
  texts(viewer);
  events<AudienceChange>();
  session_.publish(picture_of(2));
  ASSERT_TRUE(session_.next_frame(viewer).has_value());  // the socket is busy with its first half
  session_.publish(picture_of(2));
  EXPECT_FALSE(events<AudienceChange>().at(0).ready);
}

// ---- what waits for a slow page

TEST_F(SessionTest, StatesOfOneTypeReplaceEachOtherWhileAPageIsSlow) {
  set_welcome();
  const Viewer viewer = enter();
  texts(viewer);
  for (int i = 0; i < 1000; ++i) {
    session_.broadcast(R"({"type":"status","epoch":)" + std::to_string(i) + "}");
    session_.broadcast(R"({"type":"view","width":)" + std::to_string(i) + "}");
  }
  const auto said = texts(viewer);
  ASSERT_EQ(said.size(), 2U);
  EXPECT_EQ(said[0].at("epoch"), 999);
  EXPECT_EQ(said[1].at("width"), 999);
}

TEST_F(SessionTest, AnswersAreKeptInOrderAndLimitedInNumber) {
  set_welcome();
  const Viewer viewer = enter();
  texts(viewer);
  for (std::size_t i = 0; i < Session::kMaxQueuedTexts; ++i) {
    session_.receive_text(viewer, R"({"type":"ping","time":)" + std::to_string(i) + "}");
  }
  const auto said = texts(viewer);
  ASSERT_EQ(said.size(), Session::kMaxQueuedTexts);
  for (std::size_t i = 0; i < said.size(); ++i) EXPECT_EQ(said[i].at("time"), i);

  const Viewer heir = enter();
  for (std::size_t i = 0; i <= Session::kMaxQueuedTexts; ++i) {
    session_.receive_text(viewer, R"({"type":"ping","time":0})");
  }
  EXPECT_EQ(closed(viewer), "the page does not read what it is sent");
  EXPECT_EQ(texts(heir).back().at("driver"), heir);
}

TEST_F(SessionTest, WhatWaitsIsLimitedInBytes) {
  set_welcome();
  const Viewer viewer = enter();
  texts(viewer);
  const std::string large =
      R"({"type":"refused","what":")" + std::string(Session::kMaxQueuedBytes / 4, 'x') + R"("})";
  for (int i = 0; i < 3; ++i) session_.send(viewer, large);
  EXPECT_EQ(texts(viewer).size(), 3U);
  for (int i = 0; i < 4; ++i) session_.send(viewer, large);
  EXPECT_EQ(closed(viewer), "the page does not read what it is sent");
}

TEST_F(SessionTest, PicturesThatAreOvertakenAreLetGo) {
  set_welcome();
  const Viewer viewer = enter();
  texts(viewer);
  std::vector<std::weak_ptr<const NumberedPicture>> known;
  for (int i = 0; i < 5; ++i) {
    session_.publish(picture_of(1));
    for (const Frame& frame : drain(viewer)) known.push_back(std::get<RegionFrame>(frame).picture);
  }
  ASSERT_EQ(known.size(), 2U);
  EXPECT_TRUE(known[0].expired());
  EXPECT_TRUE(known[1].expired());
}

TEST_F(SessionTest, AllPagesAreToldThatTheServerEnds) {
  const Viewer a = enter();
  const Viewer b = session_.open();
  session_.close_all(Session::kGoingAway, "the server ends");
  EXPECT_EQ(closed(a, Session::kGoingAway), "the server ends");
  EXPECT_EQ(closed(b, Session::kGoingAway), "the server ends");
}

TEST_F(SessionTest, OurOwnMalformedMessagesAreBugs) {
  const Viewer viewer = enter();
  for (const char* json : {"", "[]", "{}", R"({"type":1})", "{\"type\":\"view\""}) {
    EXPECT_THROW(session_.broadcast(json), std::invalid_argument);
    EXPECT_THROW(session_.set_welcome(json), std::invalid_argument);
    EXPECT_THROW(session_.send(viewer, json), std::invalid_argument);
  }
  EXPECT_THROW(session_.publish(picture_of(0)), std::invalid_argument);
}

// The laws hold whatever pages do: random pages, seeds named, no wall clock.
class RandomSession : public SessionTest, public testing::WithParamInterface<unsigned> {};

TEST_P(RandomSession, KeepsTheLaws) {
  std::mt19937 random(GetParam());
  const auto below = [&](std::uint32_t n) { return static_cast<std::uint32_t>(random() % n); };
  struct Seen {
    std::uint32_t serial = 0, newest = 0, last_acked = 0;
    std::size_t next_region = 0, open = 0;
  };
  std::map<Viewer, Seen> pages;
  std::uint32_t published = 0;
  for (int step = 0; step < 4000; ++step) {
    if (pages.size() < 5 && below(20) == 0) pages[enter()] = {};
    if (step == 500) set_welcome();
    if (below(4) == 0) {
      session_.publish(picture_of(1 + below(4)));
      ++published;
    }
    if (pages.empty()) continue;
    const auto chosen = std::next(pages.begin(), below(static_cast<std::uint32_t>(pages.size())));
    const Viewer viewer = chosen->first;
    Seen& seen = chosen->second;
    switch (below(6)) {
      case 0:
        session_.receive_text(viewer, camera(++seen.serial));
        break;
      case 1:
        session_.receive_text(viewer, R"({"type":"drive"})");
        break;
      case 2:
        if (seen.next_region == 0 && seen.newest > seen.last_acked) {
          session_.receive_text(viewer, ack(seen.newest));
          seen.last_acked = seen.newest;
          seen.open = 0;
        }
        break;
      case 3:
        if (below(30) == 0) {
          session_.gone(viewer);
          pages.erase(chosen);
        }
        break;
      default: {
        const auto frame = session_.next_frame(viewer);
        if (!frame || !std::holds_alternative<RegionFrame>(*frame)) break;
        const auto& region = std::get<RegionFrame>(*frame);
        ASSERT_EQ(region.region, seen.next_region);
        if (region.region == 0) {
          ASSERT_GT(region.picture->number, seen.newest);
          seen.newest = region.picture->number;
          ASSERT_LE(++seen.open, Session::kMaxUnacknowledged);
        }
        ASSERT_EQ(region.picture->number, seen.newest);
        const bool last = region.region + 1 == region.picture->headers.size();
        seen.next_region = last ? 0 : region.region + 1;
      }
    }
  }
  // Who acknowledges everything ends with the newest picture.
  for (auto& [viewer, seen] : pages) {
    for (bool more = true; more;) {
      more = false;
      for (const Frame& frame : drain(viewer)) {
        if (const auto* region = std::get_if<RegionFrame>(&frame)) {
          seen.newest = region->picture->number;
        }
      }
      if (seen.newest > seen.last_acked) {
        session_.receive_text(viewer, ack(seen.last_acked = seen.newest));
        more = true;
      }
    }
    EXPECT_EQ(seen.newest, published);
  }
}
INSTANTIATE_TEST_SUITE_P(Seeds, RandomSession, testing::Range(1U, 21U));

}  // namespace
}  // namespace goldthread
