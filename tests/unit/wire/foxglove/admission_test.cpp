#include "server/wire/foxglove/admission.hpp"

#include <gtest/gtest.h>

namespace isthmus::foxglove {
namespace {

const std::string token = "0123456789abcdef";

Handshake from(const std::string& host, const std::string& origin = "") {
  return {"/", host, origin, "", ""};
}

TEST(FoxgloveAdmission, WithoutATokenThisMachineAndNoPageOfAnotherSite) {
  const Access access;
  EXPECT_TRUE(may_watch(access, from("127.0.0.1:8765")));
  EXPECT_TRUE(may_watch(access, from("localhost:8765", "http://localhost:8080")));
  EXPECT_TRUE(may_watch(access, from("[::1]:8765", "http://[::1]:8080")));
  EXPECT_TRUE(may_watch(access, from("localhost:8765", "https://app.foxglove.dev")));
  EXPECT_TRUE(may_watch(access, from("localhost:8765", "lichtblick://app")));
  EXPECT_FALSE(may_watch(access, from("localhost:8765", "https://evil.example")));
  EXPECT_FALSE(may_watch(access, from("localhost:8765", "https://app.foxglove.dev.evil.example")));
  EXPECT_FALSE(may_watch(access, from("localhost:8765", "http://127.0.0.1.evil.example")));
  EXPECT_FALSE(may_watch(access, from("localhost:8765", "http://localhost.evil.example")));
  EXPECT_FALSE(may_watch(access, from("localhost:8765", "null")));
  EXPECT_FALSE(may_watch(access, from("evil.example:8765")));
  EXPECT_FALSE(may_watch(access, from("127.0.0.1.evil.example:8765")));
}

TEST(FoxgloveAdmission, WithATokenWhoHasItInTheQueryOrAsBearer) {
  const Access access(token);
  EXPECT_FALSE(may_watch(access, from("127.0.0.1:8765")));
  EXPECT_TRUE(may_watch(access, {"/?token=" + token, "robots.example", "https://any.example", "", ""}));
  EXPECT_TRUE(may_watch(access, {"/?a=b&token=" + token + "&c", "robots.example", "", "", ""}));
  EXPECT_TRUE(may_watch(access, {"/", "robots.example", "", "Bearer " + token, ""}));
  EXPECT_FALSE(may_watch(access, {"/?token=" + token + "0", "robots.example", "", "", ""}));
  EXPECT_FALSE(may_watch(access, {"/?nottoken=" + token, "robots.example", "", "", ""}));
  EXPECT_FALSE(may_watch(access, {"/token=" + token, "robots.example", "", "", ""}));
}

TEST(FoxgloveAdmission, SpeaksTheProtocolByEitherName) {
  const auto spoken = [](const std::string& asked) { return subprotocol_for({"", "", "", "", asked}); };
  EXPECT_EQ(spoken("foxglove.websocket.v1"), "foxglove.websocket.v1");
  EXPECT_EQ(spoken("foxglove.websocket.v1, foxglove.sdk.v1"), "foxglove.sdk.v1");
  EXPECT_EQ(spoken("chat,foxglove.websocket.v1"), "foxglove.websocket.v1");
  EXPECT_EQ(spoken("foxglove.websocket.v10"), "");
  EXPECT_EQ(spoken(""), "");
}

}  // namespace
}  // namespace isthmus::foxglove
