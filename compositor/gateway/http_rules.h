// SPDX-License-Identifier: Apache-2.0
#pragma once
// What an HTTP request is answered with, without sockets: the page's files, a clear refusal, or the
// upgrade to a session. A page of another origin, or one that reached this machine by a name that
// an attacker's DNS gave it, gets nothing.

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace goldthread {

/// The parts of a request that decide. Views live as long as the request.
struct HttpRequest {
  std::string_view method;
  std::string_view target;
  std::vector<std::string_view> hosts;    ///< each Host field
  std::vector<std::string_view> origins;  ///< each Origin field
  std::string_view if_none_match;
  bool has_body = false;
  bool websocket_upgrade = false;  ///< asks for one, well-formed
};

struct HttpReply {
  unsigned status = 200;
  std::vector<std::pair<std::string, std::string>> fields;
  std::span<const char> page;  ///< the body, if it is an embedded file …
  std::string text;            ///< … else this
};

struct HttpPolicy {
  bool loopback = true;  ///< bound to a loopback address: only loopback's names are right
  std::string host;      ///< as it was asked to bind to
  std::string token;
};

/// The answer, or nothing: go on with the WebSocket handshake.
std::optional<HttpReply> answer(const HttpRequest& request, const HttpPolicy& policy);

/// Is `host_field` ("name", "name:port", "[v6]:port") one by which loopback is reached?
bool is_loopback_name(std::string_view host_field, const HttpPolicy& policy);

/// Takes the same time whatever the first difference is.
bool same_secret(std::string_view given, std::string_view expected);

/// The decoded value of a target's query parameter, if it is there once and well-formed.
std::optional<std::string> query_parameter(std::string_view target, std::string_view name);

}  // namespace goldthread
