#include "server/wire/page/http/access.hpp"

#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

TEST(Access, WithoutATokenOnlyNamesOfThisMachineLeadToThePage) {
  const Access access;
  for (const char* host : {"127.0.0.1:8080", "localhost:8080", "localhost", "[::1]:8080"})
    EXPECT_TRUE(access.may_see({host, "", "", ""})) << host;
  for (const char* host :
       {"", "evil.example:8080", "localhost.evil.example", "127.0.0.1.evil.example", "192.168.1.5:8080", "["})
    EXPECT_FALSE(access.may_see({host, "", "", ""})) << host;
}

TEST(Access, ATokenIsACookieOrABearer) {
  const Access access("0123456789abcdef");
  const std::string host = "192.168.1.5:8080";
  EXPECT_TRUE(access.may_see({host, "", "isthmus_token=0123456789abcdef", ""}));
  EXPECT_TRUE(access.may_see({host, "", "a=b; isthmus_token=0123456789abcdef; c=d", ""}));
  EXPECT_TRUE(access.may_see({host, "", "", "Bearer 0123456789abcdef"}));
  for (const char* cookie :
       {"", "isthmus_token=", "isthmus_token=0123456789abcdeF", "xisthmus_token=0123456789abcdef",
        "isthmus_token", "a=isthmus_token=0123456789abcdef", ";;  ;"})
    EXPECT_FALSE(access.may_see({"localhost", "", cookie, ""})) << cookie;
  EXPECT_FALSE(access.may_see({"localhost", "", "isthmus_token=0123456789abcdef", "Bearer wrong"}));
}

TEST(Access, OrdersOfOtherSitesPagesAreRefused) {
  const Access access;
  EXPECT_TRUE(access.may_order({"127.0.0.1:8080", "", "", ""}));
  EXPECT_TRUE(access.may_order({"127.0.0.1:8080", "http://127.0.0.1:8080", "", ""}));
  EXPECT_FALSE(access.may_order({"127.0.0.1:8080", "http://127.0.0.1:9090", "", ""}));
  EXPECT_FALSE(access.may_order({"127.0.0.1:8080", "https://evil.example", "", ""}));
  EXPECT_FALSE(access.may_order({"127.0.0.1:8080", "null", "", ""}));
}

TEST(Access, ATokenFileHoldsOneTokenThatCannotBeGuessed) {
  const TemporaryDirectory directory;
  directory.write("token", " 0123456789abcdef\n");
  EXPECT_EQ(read_token(directory / "token"), "0123456789abcdef");
  for (const char* text : {"", "short", "0123456789abcdef 0123456789abcdef", "0123456789abcde;"}) {
    directory.write("token", text);
    EXPECT_THROW(read_token(directory / "token"), std::runtime_error) << text;
  }
}

}  // namespace
}  // namespace isthmus
