#include "server/wire/message/server_configuration.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "tests/support/temporary_directory.hpp"

namespace isthmus {
namespace {

ServerConfiguration parsed(const std::string& toml) { return parse_server_configuration(toml, "c.toml"); }

std::string error_in(const std::string& toml) {
  return error_of([&] { parsed(toml); });
}

TEST(ConfigurationExploration, IsOffUnlessItIsAskedFor) {
  EXPECT_FALSE(parsed("").exploration.enabled);
  EXPECT_FALSE(parsed("[exploration]\n").exploration.enabled);
  const auto asked =
      parsed("[exploration]\nenabled = true\nclearance_m = 0.2\nspeed_m_s = 0.3\n").exploration;
  EXPECT_TRUE(asked.enabled);
  EXPECT_EQ(asked.clearance_m, 0.2);
  EXPECT_EQ(asked.speed_m_s, 0.3);
  EXPECT_NE(error_in("[exploration]\nenable = true").find("unknown key 'enable' in [exploration]"),
            std::string::npos);
  EXPECT_NE(error_in("[exploration]\nspeed_m_s = 0").find("c.toml:2"), std::string::npos);
  EXPECT_EQ(parsed("[exploration]\nsearch_place = \"dock\"\n").exploration.search_place, "dock");
  EXPECT_NE(error_in("[exploration]\nsearch_radius_m = 0").find("c.toml:2"), std::string::npos);
}

TEST(ConfigurationChannels, AreReadByRobot) {
  const ServerConfiguration configuration = parsed(
      "[robots.r1]\nbarcode = 5\nchannels = { scan = \"HOKUYO\" }\n[robots.R2]\n"
      "channels = { odometry = \"WHEELS\", sighting = \"TAGS\" }\n[robots.R3]\n");
  EXPECT_EQ(configuration.channels.at("R1").scan, "HOKUYO");
  EXPECT_EQ(configuration.channels.at("R1").odometry, "");
  EXPECT_EQ(configuration.channels.at("R2").odometry, "WHEELS");
  EXPECT_EQ(configuration.channels.at("R2").sighting, "TAGS");
  EXPECT_FALSE(configuration.channels.contains("R3"));
  EXPECT_TRUE(configuration.engine.robots.at("R1").declared) << "the engine's part is read too";
  EXPECT_EQ(channels_of(configuration.engine).at("R1").scan, "HOKUYO");
}

TEST(ConfigurationChannels, AreRefusedWithTheirLine) {
  EXPECT_EQ(
      error_in("[robots.R1]\nchannels = {scn = \"A\"}"),
      "c.toml:2: unknown key 'scn' in channels; did you mean 'scan'? (known: odometry, scan, sighting)");
  EXPECT_EQ(error_in("[robots.R1]\nchannels = {scan = \"\"}"), "c.toml:2: a channel has 1 to 63 characters");
  EXPECT_EQ(error_in("[robots.R1]\nchannels = 5"), "c.toml:2: channels must be a table");
  EXPECT_EQ(error_in("[robots.R1]\nchannels = {scan = \"A\"}\n[robots.R2]\nchannels = {scan = \"A\"}"),
            "c.toml:3: channel 'A' of robot R2 is given already to R1");
  EXPECT_TRUE(error_in("estimator = \"segmnts\"").ends_with("did you mean 'segments'?"));
  EXPECT_EQ(error_in("\nnonsense = 1").substr(0, 30), "c.toml:2: unknown key 'nonsens");
}

TEST(ConfigurationChannels, OfTheExampleAreAllShown) {
  std::ifstream file("server/isthmus.example.toml");
  std::ostringstream text;
  text << file.rdbuf();
  for (const char* key : {"odometry =", "scan =", "sighting =", "channels ="})
    EXPECT_NE(text.str().find(key), std::string::npos) << key;
  EXPECT_TRUE(parsed(text.str()).channels.empty());
}

const std::string key_text = "0123456789abcdefABCDEF" + std::string(42, '0');

TEST(ConfigurationKeys, AreReadByName) {
  const ServerConfiguration configuration =
      parsed("[auth.robots]\nr1 = \"" + key_text + "\"\n[auth.operators]\nalice = \"" + key_text + "\"\n");
  EXPECT_TRUE(configuration.authentication.is_required());
  EXPECT_FALSE(configuration.authentication.withheld);
  const AuthKey& key = configuration.authentication.robots.at("R1");
  EXPECT_EQ(key[0], 0x01);
  EXPECT_EQ(key[10], 0xEF);
  EXPECT_TRUE(configuration.authentication.operators.contains("ALICE"));
  EXPECT_FALSE(parsed("").authentication.is_required());
}

TEST(ConfigurationKeys, AreRefusedWithTheirLine) {
  EXPECT_EQ(error_in("[auth.robots]\nR1 = \"12\""),
            "c.toml:2: the key of R1 must be 64 hexadecimal digits in quotes");
  EXPECT_EQ(error_in("[auth.robots]\nR1 = \"" + std::string(64, 'g') + "\""),
            "c.toml:2: the key of R1 must be 64 hexadecimal digits in quotes");
  EXPECT_EQ(error_in("[auth.robots]\nR1 = 12"),
            "c.toml:2: the key of R1 must be 64 hexadecimal digits in quotes");
  EXPECT_EQ(error_in("[auth]\n"), "c.toml:1: [auth] without a key");
  EXPECT_NE(error_in("[auth.robots]\na = \"" + key_text + "\"\n[auth.operators]\nA = \"" + key_text + "\"\n")
                .find("A is both a robot and an operator"),
            std::string::npos);
}

TEST(ConfigurationKeys, DoNotShowInTheTextWithoutThem) {
  const std::string plain = "tags = \"any\"  # as written\n";
  EXPECT_EQ(without_keys(plain), plain);
  const std::string text =
      "tags = \"any\"\n[engine]\npatch_spacing_m = 0.1\n[auth.robots]\nR1 = \"" + key_text + "\"\n";
  const std::string shown = without_keys(text);
  EXPECT_EQ(shown.find(key_text), std::string::npos);
  const ServerConfiguration configuration = parsed(shown);
  EXPECT_TRUE(configuration.authentication.withheld);
  EXPECT_TRUE(configuration.engine.any_tag);
  EXPECT_EQ(configuration.engine.engine.patch_spacing_m, 0.1);
}

TEST(ConfigurationKeys, DoNotMatterToWhatIsMapped) {
  EXPECT_TRUE(map_alike("tags = \"any\" # so\n", "tags   = \"any\"\n[auth.robots]\nR1 = \"\"\n"));
  EXPECT_TRUE(map_alike("[exploration]\nenabled = true\n", ""));
  EXPECT_FALSE(map_alike("tags = \"any\"\n", ""));
}

}  // namespace
}  // namespace isthmus
