// SPDX-License-Identifier: Apache-2.0
#include "compositor/gateway/address_hint.h"

#include <gtest/gtest.h>

namespace goldthread {
namespace {

TEST(AddressHint, ALoopbackSessionIsReachedThroughATunnel) {
  const AddressHint hint = address_hint("127.0.0.1", 8080, "abc", "ada@node17");
  EXPECT_EQ(hint.url, "http://127.0.0.1:8080/?token=abc");
  EXPECT_EQ(hint.ssh_line, "ssh -L 8080:127.0.0.1:8080 ada@node17");
  EXPECT_EQ(hint.ssh_url, "http://127.0.0.1:8080/?token=abc");
}

TEST(AddressHint, ASessionForTheWholeNetworkIsNamedAfterItsMachine) {
  for (const char* host : {"0.0.0.0", "::"}) {
    const AddressHint hint = address_hint(host, 9000, "abc", "ada@node17");
    EXPECT_EQ(hint.url, "http://node17:9000/?token=abc");
    EXPECT_EQ(hint.ssh_line, "ssh -L 9000:127.0.0.1:9000 ada@node17");
  }
}

TEST(AddressHint, AnIpv6AddressStandsInBrackets) {
  const AddressHint hint = address_hint("::1", 8080, "abc", "node17");
  EXPECT_EQ(hint.url, "http://[::1]:8080/?token=abc");
  EXPECT_EQ(hint.ssh_line, "ssh -L 8080:[::1]:8080 node17");
}

TEST(AddressHint, ATokenMayHoldAnyCharacters) {
  EXPECT_EQ(address_hint("localhost", 1, "a b&c=%/\xc3\xa9", "m").url,
            "http://localhost:1/?token=a%20b%26c%3D%25%2F%C3%A9");
}

}  // namespace
}  // namespace goldthread
