// SPDX-License-Identifier: Apache-2.0
#include "compositor/gateway/address_hint.h"

#include <string_view>

namespace goldthread {
namespace {

std::string percent_encoded(std::string_view text) {
  constexpr std::string_view kUnreserved =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~";
  constexpr char kHex[] = "0123456789ABCDEF";
  std::string result;
  for (const char c : text) {
    if (kUnreserved.find(c) != std::string_view::npos) {
      result += c;
    } else {
      const auto byte = static_cast<unsigned char>(c);
      result += {'%', kHex[byte >> 4], kHex[byte & 15]};
    }
  }
  return result;
}

std::string bracketed(const std::string& host) {
  const bool v6 = host.find(':') != std::string::npos && host.front() != '[';
  return v6 ? "[" + host + "]" : host;
}

}  // namespace

AddressHint address_hint(const std::string& host, std::uint16_t port, const std::string& token,
                         const std::string& machine) {
  const bool everywhere = host == "0.0.0.0" || host == "::" || host == "*" || host.empty();
  const std::string machine_host = machine.substr(machine.find('@') + 1);
  const std::string port_text = std::to_string(port);
  const std::string path = ":" + port_text + "/?token=" + percent_encoded(token);
  const std::string far_end = everywhere ? "127.0.0.1" : bracketed(host);
  return {.url = "http://" + (everywhere ? bracketed(machine_host) : bracketed(host)) + path,
          .ssh_line = "ssh -L " + port_text + ":" + far_end + ":" + port_text + " " + machine,
          .ssh_url = "http://127.0.0.1" + path};
}

}  // namespace goldthread
