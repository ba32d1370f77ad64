// SPDX-License-Identifier: Apache-2.0
#pragma once
// What to tell the user who started a session: where to point a browser.

#include <cstdint>
#include <string>

namespace goldthread {

struct AddressHint {
  std::string url;       ///< to open on the machine that serves (or any, if it serves the network)
  std::string ssh_line;  ///< to run on the user's own machine, whose browser then opens `ssh_url`
  std::string ssh_url;
};

/// For a session bound to `host` and `port`; `machine` is how ssh reaches the machine that serves
/// ("node17" or "user@node17"). `token` may hold any characters.
AddressHint address_hint(const std::string& host, std::uint16_t port, const std::string& token,
                         const std::string& machine);

}  // namespace goldthread
