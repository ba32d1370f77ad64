// SPDX-License-Identifier: Apache-2.0
#include "compositor/gateway/page_message.h"

#include <gtest/gtest.h>

#include <string>

namespace goldthread::page {
namespace {

const std::string kCamera =
    R"("camera":{"position":[0,-500,20],"target":[0,0,20.5],"up":[0,0,1],"fovy":30})";

template <class T>
T decoded(const std::string& text) {
  const Result<Message> message = decode(text);
  if (!message) {
    ADD_FAILURE() << text << ": " << message.failure().line();
    return {};
  }
  if (!std::holds_alternative<T>(*message)) {
    ADD_FAILURE() << text << " is another message";
    return {};
  }
  return std::get<T>(*message);
}

TEST(PageMessage, EachMessageOfTheProtocolIsDecoded) {
  EXPECT_EQ(decoded<Hello>(R"({"type":"hello","protocol":2})").protocol, 2);
  const auto move = decoded<MoveCamera>(R"({"type":"camera","serial":7,)" + kCamera + "}");
  EXPECT_EQ(move.serial, 7U);
  EXPECT_EQ(move.camera, (Camera{{0, -500, 20}, {0, 0, 20.5}, {0, 0, 1}, 30}));
  const auto edit = decoded<Edit>(R"({"type":"edit","serial":2,"edit":{"step":0.25}})");
  EXPECT_EQ(edit.serial, 2U);
  EXPECT_EQ(edit.edit_json, R"({"step":0.25})");
  const auto size = decoded<Resize>(R"({"type":"size","serial":3,"width":640,"height":480})");
  EXPECT_EQ(size.width, 640);
  EXPECT_EQ(size.height, 480);
  const auto display =
      decoded<Display>(R"({"type":"display","serial":4,"filter":"box","update":"50","cine":true})");
  EXPECT_EQ(display.serial, 4U);
  EXPECT_EQ(display.filter, "box");
  EXPECT_EQ(display.update, "50");
  EXPECT_TRUE(display.cine);
  const auto watch = decoded<Watch>(R"({"type":"watch","load":true,"tiles":false})");
  EXPECT_TRUE(watch.load);
  EXPECT_FALSE(watch.tiles);
  decoded<Drive>(R"({"type":"drive"})");
  EXPECT_EQ(decoded<Ack>(R"({"type":"ack","picture":4294967295})").picture, 4294967295U);
  EXPECT_EQ(decoded<Ping>(R"({"type":"ping","time":12.5})").time, 12.5);
}

TEST(PageMessage, EverythingElseIsMalformed) {
  const std::string bad[] = {
      "",
      " ",
      "{",
      "null",
      "[]",
      "\"hello\"",
      "{}",
      R"({"type":1})",
      R"({"type":"halo"})",
      R"({"type":"hello"})",
      R"({"type":"hello","protocol":"1"})",
      R"({"type":"hello","protocol":2.5})",
      R"({"type":"hello","protocol":2} x)",
      R"({"type":"camera","serial":1})",
      R"({"type":"camera",)" + kCamera + "}",
      R"({"type":"camera","serial":0,)" + kCamera + "}",
      R"({"type":"camera","serial":-1,)" + kCamera + "}",
      R"({"type":"camera","serial":4294967296,)" + kCamera + "}",
      R"({"type":"camera","serial":18446744073709551615,)" + kCamera + "}",
      R"({"type":"camera","serial":1e30,)" + kCamera + "}",
      R"({"type":"camera","serial":true,)" + kCamera + "}",
      R"({"type":"camera","serial":1,"camera":{"position":[0,0],"target":[0,0,0],"up":[0,0,1],"fovy":30}})",
      R"({"type":"camera","serial":1,"camera":{"position":[0,0,null],"target":[0,0,0],"up":[0,0,1],"fovy":30}})",
      R"({"type":"camera","serial":1,"camera":{"position":[0,0,1e400],"target":[0,0,0],"up":[0,0,1],"fovy":30}})",
      R"({"type":"camera","serial":1,"camera":{"position":[0,0,NaN],"target":[0,0,0],"up":[0,0,1],"fovy":30}})",
      R"({"type":"camera","serial":1,"camera":{"position":[0,0,1],"target":[0,0,0],"up":[0,0,1],"fovy":"30"}})",
      R"({"type":"edit","serial":1})",
      R"({"type":"edit","serial":1,"edit":[]})",
      R"({"type":"size","serial":1,"width":64})",
      R"({"type":"size","serial":1,"width":64.5,"height":64})",
      R"({"type":"display","filter":"box","update":"50","cine":true})",
      R"({"type":"display","serial":1,"update":"50","cine":true})",
      R"({"type":"display","serial":1,"filter":1,"update":"50","cine":true})",
      R"({"type":"display","serial":1,"filter":"box","update":50,"cine":true})",
      R"({"type":"display","serial":1,"filter":"box","update":"50","cine":1})",
      R"({"type":"display","serial":1,"filter":"box","update":"50"})",
      R"({"type":"watch"})",
      R"({"type":"watch","load":true})",
      R"({"type":"watch","tiles":true})",
      R"({"type":"watch","load":1,"tiles":true})",
      R"({"type":"watch","load":true,"tiles":"true"})",
      R"({"type":"watch","load":true,"tiles":[true]})",
      R"({"type":"watch","load":null,"tiles":null})",
      R"({"type":"ack"})",
      R"({"type":"ack","picture":-3})",
      R"({"type":"ping","time":null})",
      "{\"type\":\"\xff\xfe\"}",
      std::string("{\"type\":\"drive\"}\0", 17)};
  for (const std::string& text : bad) EXPECT_FALSE(decode(text).ok()) << text;
}

TEST(PageMessage, ReasonsNeverRepeatThePagesText) {
  const Result<Message> message = decode(R"({"type":"<script>"})");
  ASSERT_FALSE(message.ok());
  EXPECT_EQ(message.failure().line().find("script"), std::string::npos);
}

TEST(PageMessage, NestingIsLimited) {
  const auto nested = [](std::size_t depth) {
    // The message and its `edit` are two levels themselves.
    return R"({"type":"edit","serial":1,"edit":{"lights":)" + std::string(depth - 2, '[') +
           std::string(depth - 2, ']') + "}}";
  };
  EXPECT_TRUE(decode(nested(kMaxNesting)).ok());
  EXPECT_FALSE(decode(nested(kMaxNesting + 1)).ok());
  EXPECT_FALSE(decode(std::string(kMaxMessageBytes, '[')).ok());
}

TEST(PageMessage, BracketsInsideStringsAreText) {
  const std::string text =
      R"({"type":"edit","serial":1,"edit":{"a\"[[[":")" + std::string(100, '[') + R"("}})";
  EXPECT_TRUE(decode(text).ok());
}

TEST(PageMessage, SizeIsLimited) {
  const std::string frame = R"({"type":"edit","serial":1,"edit":{"a":""}})";
  const auto of_size = [&](std::size_t bytes) {
    std::string text = frame;
    return text.insert(text.size() - 3, bytes - frame.size(), 'x');
  };
  EXPECT_TRUE(decode(of_size(kMaxMessageBytes)).ok());
  EXPECT_FALSE(decode(of_size(kMaxMessageBytes + 1)).ok());
}

TEST(PageMessage, ACameraMustBeAbleToSee) {
  const Camera good{{0, -500, 20}, {0, 0, 20}, {0, 0, 1}, 30};
  EXPECT_FALSE(refusal(good).has_value());
  const auto refused = [&](auto spoil) {
    Camera camera = good;
    spoil(camera);
    return refusal(camera).has_value();
  };
  EXPECT_TRUE(refused([](Camera& c) { c.target = c.position; }));
  EXPECT_TRUE(refused([](Camera& c) { c.up = {0, 3, 0}; }));
  EXPECT_TRUE(refused([](Camera& c) { c.up = {0, 0, 0}; }));
  EXPECT_TRUE(refused([](Camera& c) { c.up = {0, 0, 1e-320}; }));
  EXPECT_TRUE(refused([](Camera& c) { c.position.x = 1e300; }));
  EXPECT_TRUE(refused([](Camera& c) { c.fovy_deg = 0; }));
  EXPECT_TRUE(refused([](Camera& c) { c.fovy_deg = 180; }));
  EXPECT_FALSE(refused([](Camera& c) { c.up *= 1e-6; }));
}

TEST(PageMessage, DisplaySettingsHaveTheNamesOfTheProtocol) {
  const std::pair<const char*, Filter> filters[] = {
      {"box", Filter::kBox},
      {"bilinear", Filter::kBilinear},
      {"biquadratic", Filter::kBiquadratic},
      {"piecewise-quadratic", Filter::kPiecewiseQuadratic},
      {"bicubic", Filter::kBicubic}};
  const std::pair<const char*, Update> updates[] = {{"100", Update::kAll},
                                                    {"50", Update::kHalf},
                                                    {"25", Update::kQuarter},
                                                    {"frameless", Update::kFrameless}};
  for (const auto& [filter, as_filter] : filters) {
    for (const auto& [update, as_update] : updates) {
      const auto settings = settings_of(Display{1, filter, update, true});
      ASSERT_TRUE(settings.ok()) << filter << " " << update;
      EXPECT_EQ(*settings, (DisplaySettings{as_filter, as_update, true}));
    }
  }
  for (const char* unknown : {"", "Box", "75", "boxes", "<b>"}) {
    const auto filter = settings_of(Display{1, unknown, "50", false});
    ASSERT_FALSE(filter.ok());
    EXPECT_EQ(filter.failure().where, "display.filter");
    const auto update = settings_of(Display{1, "box", unknown, false});
    ASSERT_FALSE(update.ok());
    EXPECT_EQ(update.failure().where, "display.update");
    EXPECT_EQ(update.failure().line().find("<b>"), std::string::npos);
  }
}

TEST(PageMessage, SizesRunFrom16To4096) {
  for (const std::int64_t side : {16, 17, 4095, 4096}) {
    EXPECT_FALSE(refusal(Resize{1, side, 512}).has_value()) << side;
    EXPECT_FALSE(refusal(Resize{1, 512, side}).has_value()) << side;
  }
  for (const std::int64_t side : {std::int64_t{15}, std::int64_t{0}, std::int64_t{-16},
                                  std::int64_t{4097}, std::int64_t{1} << 40}) {
    EXPECT_TRUE(refusal(Resize{1, side, 512}).has_value()) << side;
    EXPECT_TRUE(refusal(Resize{1, 512, side}).has_value()) << side;
  }
}

}  // namespace
}  // namespace goldthread::page
