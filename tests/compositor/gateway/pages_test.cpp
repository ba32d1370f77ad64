// SPDX-License-Identifier: Apache-2.0
#include "compositor/gateway/pages.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

namespace goldthread {
namespace {

namespace fs = std::filesystem;

TEST(Pages, TheRootIsTheIndex) {
  const EmbeddedPage* index = find_page("/");
  ASSERT_NE(index, nullptr);
  EXPECT_EQ(index, find_page("/index.html"));
  const std::string_view text(index->bytes.data(), index->bytes.size());
  EXPECT_NE(text.find("<html"), std::string_view::npos);
}

TEST(Pages, EachEmbeddedFileIsFoundByItsPath) {
  const auto pages = embedded_pages();
  ASSERT_FALSE(pages.empty());
  EXPECT_TRUE(std::is_sorted(pages.begin(), pages.end(),
                             [](const auto& a, const auto& b) { return a.path < b.path; }));
  for (const EmbeddedPage& page : pages) {
    EXPECT_EQ(find_page(page.path), &page);
    EXPECT_EQ(page.etag.size(), 34U);
    EXPECT_NE(mime_type(page.path), "application/octet-stream") << page.path;
  }
}

TEST(Pages, TypesFollowTheExtension) {
  EXPECT_EQ(mime_type("/assets/a-1b2c.js"), "text/javascript; charset=utf-8");
  EXPECT_EQ(mime_type("/a.wasm"), "application/wasm");
  EXPECT_EQ(mime_type("/a"), "application/octet-stream");
}

// The script that embeds, on a folder of the test's own.
class EmbedScript : public testing::Test {
 protected:
  void SetUp() override {
    // One for each test: they run side by side.
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    root_ = fs::path(testing::TempDir()) / (std::string("goldthread_embed_") + test->name());
    fs::remove_all(root_);
    fs::create_directories(root_ / "dist" / "assets");
  }
  void TearDown() override { fs::remove_all(root_); }

  void put(const std::string& name, const std::string& content) const {
    std::ofstream(root_ / "dist" / name) << content;
  }
  std::string embed() const {
    const std::string folder = std::string(GOLDTHREAD_SOURCE_DIR) + "/compositor/gateway/";
    const std::string command =
        std::string(GOLDTHREAD_CMAKE) + " -DDIST=" + (root_ / "dist").string() +
        " -DPLACEHOLDER=" + folder + "placeholder.html -DOUTPUT=" + output().string() + " -P " +
        folder + "embed_pages.cmake";
    EXPECT_EQ(std::system(command.c_str()), 0);
    std::ostringstream text;
    text << std::ifstream(output()).rdbuf();
    return text.str();
  }
  fs::path output() const { return root_ / "pages.cpp"; }

  fs::path root_;
};

TEST_F(EmbedScript, WithoutAViewerAPlaceholderIsTheIndex) {
  const std::string source = embed();
  EXPECT_NE(source.find("{\"/index.html\""), std::string::npos);
  EXPECT_NE(source.find("placeholder.html"), std::string::npos);
}

TEST_F(EmbedScript, TheSourceFollowsNamesAndContents) {
  put("index.html", "<html>");
  put("assets/index-aaaa.js", "one");
  const std::string first = embed();
  EXPECT_NE(first.find("{\"/assets/index-aaaa.js\""), std::string::npos);
  EXPECT_EQ(first.find("placeholder"), std::string::npos);

  put("assets/index-aaaa.js", "two");
  const std::string changed = embed();
  EXPECT_NE(changed, first);

  fs::remove(root_ / "dist/assets/index-aaaa.js");
  put("assets/index-bbbb.js", "two");
  const std::string renamed = embed();
  EXPECT_EQ(renamed.find("aaaa"), std::string::npos);
  EXPECT_NE(renamed.find("{\"/assets/index-bbbb.js\""), std::string::npos);
}

TEST_F(EmbedScript, NothingIsWrittenIfNothingChanged) {
  put("index.html", "<html>");
  embed();
  const fs::file_time_type long_ago{};
  fs::last_write_time(output(), long_ago);
  embed();
  EXPECT_EQ(fs::last_write_time(output()), long_ago);
}

}  // namespace
}  // namespace goldthread
