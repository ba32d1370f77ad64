// SPDX-License-Identifier: Apache-2.0
#include "compositor/gateway/http_rules.h"

#include <algorithm>
#include <cctype>

#include "compositor/gateway/pages.h"

namespace goldthread {
namespace {

constexpr std::string_view kSessionPath = "/session";

// Scripts, workers and WebAssembly of our own; images from received bytes; style elements, which
// user-interface libraries insert.
constexpr const char* kContentPolicy =
    "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self' blob:; "
    "style-src 'self' 'unsafe-inline'; img-src 'self' blob: data:; font-src 'self' data:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

HttpReply with_security(HttpReply reply) {
  for (const auto& [name, value] : {std::pair{"Content-Security-Policy", kContentPolicy},
                                    {"X-Content-Type-Options", "nosniff"},
                                    {"Referrer-Policy", "no-referrer"},
                                    {"X-Frame-Options", "DENY"},
                                    {"Cross-Origin-Opener-Policy", "same-origin"},
                                    {"Cross-Origin-Resource-Policy", "same-origin"}}) {
    reply.fields.emplace_back(name, value);
  }
  return reply;
}

HttpReply refusal(unsigned status, std::string text) {
  HttpReply reply{.status = status, .fields = {}, .page = {}, .text = std::move(text) + "\n"};
  reply.fields.emplace_back("Content-Type", "text/plain; charset=utf-8");
  reply.fields.emplace_back("Cache-Control", "no-store");
  return with_security(std::move(reply));
}

HttpReply page_reply(const EmbeddedPage& page, std::string_view if_none_match) {
  HttpReply reply;
  reply.fields.emplace_back("ETag", page.etag);
  reply.fields.emplace_back("Cache-Control", is_immutable(page.path)
                                                 ? "public, max-age=31536000, immutable"
                                                 : "no-cache");
  if (if_none_match.find(page.etag) != std::string_view::npos) {
    reply.status = 304;
  } else {
    reply.fields.emplace_back("Content-Type", mime_type(page.path));
    reply.page = page.bytes;
  }
  return with_security(std::move(reply));
}

std::string_view path_of(std::string_view target) { return target.substr(0, target.find('?')); }

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

bool same_origin(std::string_view origin, std::string_view host) {
  const std::string given = lower(origin);
  const std::string ours = lower(host);
  // https: a proxy in front of us may end TLS.
  return given == "http://" + ours || given == "https://" + ours;
}

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

std::optional<std::string> percent_decoded(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      result += text[i] == '+' ? ' ' : text[i];
      continue;
    }
    if (i + 2 >= text.size()) return std::nullopt;
    const int high = hex_digit(text[i + 1]);
    const int low = hex_digit(text[i + 2]);
    if (high < 0 || low < 0) return std::nullopt;
    result += static_cast<char>(high * 16 + low);
    i += 2;
  }
  return result;
}

bool is_loopback_v4(std::string_view name) {
  return name.starts_with("127.") && std::count(name.begin(), name.end(), '.') == 3 &&
         name.find_first_not_of("0123456789.") == std::string_view::npos;
}

// The token is judged before the upgrade: a browser does not tell its page why a handshake failed,
// so the page asks again by plain HTTP.
std::optional<HttpReply> answer_session(const HttpRequest& request, const HttpPolicy& policy) {
  // Browsers always name the origin of a WebSocket; other programs need not.
  if (request.origins.size() > 1 ||
      (request.origins.size() == 1 && !same_origin(request.origins[0], request.hosts[0]))) {
    return refusal(403, "This page comes from another origin.");
  }
  const auto token = query_parameter(request.target, "token");
  if (!token || !same_secret(*token, policy.token)) {
    return refusal(403, "The token is missing or wrong: open the URL that the program printed.");
  }
  if (request.websocket_upgrade) return std::nullopt;
  HttpReply reply = refusal(426, "This address is for WebSockets.");
  reply.fields.emplace_back("Upgrade", "websocket");
  return reply;
}

}  // namespace

bool is_loopback_name(std::string_view host_field, const HttpPolicy& policy) {
  std::string name = lower(host_field);
  if (const auto bracket = name.find(']'); bracket != std::string::npos) {
    name.resize(bracket + 1);
  } else if (const auto colon = name.find(':'); colon != std::string::npos) {
    name.resize(colon);
  }
  return name == "localhost" || name == "[::1]" || is_loopback_v4(name) ||
         name == lower(policy.host);
}

bool same_secret(std::string_view given, std::string_view expected) {
  unsigned difference = given.size() == expected.size() ? 0 : 1;
  for (std::size_t i = 0; i < given.size(); ++i) {
    const char against = expected.empty() ? '\0' : expected[i % expected.size()];
    difference |= static_cast<unsigned>(static_cast<unsigned char>(given[i] ^ against));
  }
  return difference == 0 && !expected.empty();
}

std::optional<std::string> query_parameter(std::string_view target, std::string_view name) {
  const auto question = target.find('?');
  if (question == std::string_view::npos) return std::nullopt;
  std::string_view query = target.substr(question + 1);
  std::optional<std::string> value;
  while (!query.empty()) {
    const std::string_view part = query.substr(0, query.find('&'));
    query.remove_prefix(std::min(query.size(), part.size() + 1));
    const auto equals = part.find('=');
    if (part.substr(0, equals) != name) continue;
    if (value || equals == std::string_view::npos) return std::nullopt;
    value = percent_decoded(part.substr(equals + 1));
    if (!value) return std::nullopt;
  }
  return value;
}

std::optional<HttpReply> answer(const HttpRequest& request, const HttpPolicy& policy) {
  if (request.hosts.size() != 1 || request.hosts[0].empty()) {
    return refusal(400, "A request names one host.");
  }
  if (policy.loopback && !is_loopback_name(request.hosts[0], policy)) {
    return refusal(403, "This server answers to localhost only: open the URL that it printed.");
  }
  if (request.method != "GET" && request.method != "HEAD") {
    HttpReply reply = refusal(405, "Only GET and HEAD are served.");
    reply.fields.emplace_back("Allow", "GET, HEAD");
    return reply;
  }
  if (request.has_body) return refusal(400, "A request for a page has no body.");
  if (!request.target.starts_with('/')) return refusal(400, "A target starts with a slash.");
  const std::string_view path = path_of(request.target);
  if (path == kSessionPath) return answer_session(request, policy);
  if (const EmbeddedPage* page = find_page(path)) return page_reply(*page, request.if_none_match);
  return refusal(404, "There is no such page.");
}

}  // namespace goldthread
