// SPDX-License-Identifier: Apache-2.0
#include "compositor/gateway/http_rules.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "compositor/gateway/pages.h"

namespace goldthread {
namespace {

const HttpPolicy kPolicy{true, "127.0.0.1", "secret"};

HttpRequest get(std::string_view target) {
  HttpRequest request;
  request.method = "GET";
  request.target = target;
  request.hosts = {"127.0.0.1:8080"};
  return request;
}

HttpRequest upgrade(std::string_view target) {
  HttpRequest request = get(target);
  request.websocket_upgrade = true;
  return request;
}

unsigned status(const HttpRequest& request, const HttpPolicy& policy = kPolicy) {
  const auto reply = answer(request, policy);
  return reply ? reply->status : 101;
}

std::string field(const HttpReply& reply, std::string_view name) {
  const auto found = std::find_if(reply.fields.begin(), reply.fields.end(),
                                  [&](const auto& entry) { return entry.first == name; });
  return found == reply.fields.end() ? "" : found->second;
}

TEST(HttpRules, ThePageIsServedAtTheRoot) {
  for (const char* target : {"/", "/?token=x", "/index.html"}) {
    const auto reply = answer(get(target), kPolicy);
    ASSERT_TRUE(reply.has_value());
    EXPECT_EQ(reply->status, 200U);
    EXPECT_EQ(field(*reply, "Content-Type"), "text/html; charset=utf-8");
    EXPECT_EQ(field(*reply, "Cache-Control"), "no-cache");
    EXPECT_FALSE(reply->page.empty());
  }
}

TEST(HttpRules, APageThatTheBrowserHasIsNotSentAgain) {
  const auto first = answer(get("/"), kPolicy);
  HttpRequest request = get("/");
  const std::string etag = field(*first, "ETag");
  ASSERT_FALSE(etag.empty());
  request.if_none_match = etag;
  const auto second = answer(request, kPolicy);
  EXPECT_EQ(second->status, 304U);
  EXPECT_TRUE(second->page.empty());
}

TEST(HttpRules, EveryAnswerCarriesTheSecurityHeaders) {
  HttpRequest post = get("/");
  post.method = "POST";
  for (const HttpRequest& request : {get("/"), get("/nothing"), get("/session"), post}) {
    const auto reply = answer(request, kPolicy);
    ASSERT_TRUE(reply.has_value());
    const std::string policy = field(*reply, "Content-Security-Policy");
    EXPECT_NE(policy.find("default-src 'none'"), std::string::npos);
    EXPECT_NE(policy.find("frame-ancestors 'none'"), std::string::npos);
    EXPECT_NE(policy.find("'wasm-unsafe-eval'"), std::string::npos);
    EXPECT_EQ(policy.find("script-src 'self' 'unsafe-inline'"), std::string::npos);
    EXPECT_EQ(field(*reply, "X-Content-Type-Options"), "nosniff");
    EXPECT_EQ(field(*reply, "Referrer-Policy"), "no-referrer");
  }
}

TEST(HttpRules, OtherTargetsAndMethodsAreRefused) {
  EXPECT_EQ(status(get("/nothing")), 404U);
  EXPECT_EQ(status(get("//")), 404U);
  EXPECT_EQ(status(get("index.html")), 400U);
  EXPECT_EQ(status(get("http://127.0.0.1/")), 400U);
  EXPECT_EQ(status(get("")), 400U);
  EXPECT_EQ(status(upgrade("/other?token=secret")), 404U);
  for (const char* method : {"POST", "PUT", "DELETE", "OPTIONS", "CONNECT", "TRACE", "get"}) {
    HttpRequest request = get("/");
    request.method = method;
    const auto reply = answer(request, kPolicy);
    EXPECT_EQ(reply->status, 405U) << method;
    EXPECT_EQ(field(*reply, "Allow"), "GET, HEAD");
  }
  HttpRequest with_body = get("/");
  with_body.has_body = true;
  EXPECT_EQ(status(with_body), 400U);
}

TEST(HttpRules, NoPathLeavesTheEmbeddedFiles) {
  for (const char* target :
       {"/../etc/passwd", "/../../../../etc/passwd", "/%2e%2e/etc/passwd", "/..%2fetc/passwd",
        "/assets/../../etc/passwd", "/./index.html", "/index.html/", "/index.html%00.js",
        "/assets/", "/\\..\\etc", "//etc/passwd"}) {
    EXPECT_EQ(status(get(target)), 404U) << target;
  }
}

TEST(HttpRules, OnlyLoopbacksNamesReachALoopbackServer) {
  for (const char* host : {"localhost", "LocalHost:9090", "127.0.0.1", "127.0.0.1:1", "127.1.2.3",
                           "[::1]", "[::1]:8080"}) {
    HttpRequest request = get("/");
    request.hosts = {host};
    EXPECT_EQ(status(request), 200U) << host;
  }
  for (const char* host : {"evil.example", "127.0.0.1.evil.example", "localhost.evil.example:80",
                           "10.0.0.1", "[::2]", "127.evil", "127.0.0", "a]localhost", ":80"}) {
    HttpRequest request = get("/");
    request.hosts = {host};
    EXPECT_EQ(status(request), 403U) << host;
    request = upgrade("/session?token=secret");
    request.hosts = {host};
    EXPECT_EQ(status(request), 403U) << host;
  }
}

TEST(HttpRules, AServerOfTheNetworkAnswersToAnyName) {
  HttpRequest request = get("/");
  request.hosts = {"node17.cluster.example:8080"};
  EXPECT_EQ(status(request, {false, "0.0.0.0", "secret"}), 200U);
}

TEST(HttpRules, ARequestNamesOneHost) {
  HttpRequest request = get("/");
  request.hosts = {};
  EXPECT_EQ(status(request), 400U);
  request.hosts = {"localhost", "localhost"};
  EXPECT_EQ(status(request), 400U);
  request.hosts = {""};
  EXPECT_EQ(status(request), 400U);
}

TEST(HttpRules, ASessionTakesTheRightToken) {
  EXPECT_EQ(status(upgrade("/session?token=secret")), 101U);
  EXPECT_EQ(status(upgrade("/session?a=b&token=secret")), 101U);
  EXPECT_EQ(status(upgrade("/session?token=%73ecret")), 101U);
  for (const char* target :
       {"/session", "/session?", "/session?token", "/session?token=", "/session?token=Secret",
        "/session?token=secret2", "/session?token=secre", "/session?token=secretsecret",
        "/session?tokens=secret", "/session?token=secret&token=secret", "/session?token=%7",
        "/session?token=secret%00", "/session?token=%zzsecret"}) {
    EXPECT_EQ(status(upgrade(target)), 403U) << target;
  }
}

TEST(HttpRules, PlainHttpTellsAPageWhetherItsTokenIsRight) {
  EXPECT_EQ(status(get("/session?token=wrong")), 403U);
  EXPECT_EQ(status(get("/session?token=secret")), 426U);
}

TEST(HttpRules, OnlyOurOwnPageMayOpenASession) {
  const auto from = [](std::vector<std::string_view> origins) {
    HttpRequest request = upgrade("/session?token=secret");
    request.origins = std::move(origins);
    return status(request);
  };
  EXPECT_EQ(from({}), 101U);  // not a browser
  EXPECT_EQ(from({"http://127.0.0.1:8080"}), 101U);
  EXPECT_EQ(from({"https://127.0.0.1:8080"}), 101U);
  for (const char* origin :
       {"http://127.0.0.1:8081", "http://localhost:8080", "null", "", "http://evil.example",
        "http://127.0.0.1:8080.evil.example", "file://", "ftp://127.0.0.1:8080"}) {
    EXPECT_EQ(from({origin}), 403U) << origin;
  }
  EXPECT_EQ(from({"http://127.0.0.1:8080", "http://127.0.0.1:8080"}), 403U);
}

TEST(HttpRules, SecretsAreEqualOnlyIfAllBytesAre) {
  EXPECT_TRUE(same_secret("abc", "abc"));
  EXPECT_FALSE(same_secret("abd", "abc"));
  EXPECT_FALSE(same_secret("ab", "abc"));
  EXPECT_FALSE(same_secret("abcabc", "abc"));
  EXPECT_FALSE(same_secret("", "abc"));
  EXPECT_FALSE(same_secret("", ""));
  EXPECT_FALSE(same_secret(std::string_view("abc\0", 4), "abc"));
}

}  // namespace
}  // namespace goldthread
