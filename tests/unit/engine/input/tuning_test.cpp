#include "server/engine/input/tuning.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <set>
#include <string>
#include <variant>

#include "server/engine/input/configuration.hpp"

namespace isthmus {
namespace {

/// Converts to whatever a member is.
struct Anything {
  template <class Member>
  operator Member() const;
};

/// The number of members of an aggregate.
template <class Struct, class... Given>
consteval std::size_t members_of() {
  if constexpr (requires { Struct{Given{}..., Anything{}}; }) {
    return members_of<Struct, Given..., Anything>();
  } else {
    return sizeof...(Given);
  }
}

std::string error_of(const std::string& toml) {
  const auto parsed = parse_configuration(toml, "test.toml");
  const std::string* error = std::get_if<std::string>(&parsed);
  return error == nullptr ? "" : *error;
}

EngineOptions options_of(const std::string& toml) {
  const auto parsed = parse_configuration(toml, "test.toml");
  EXPECT_TRUE(std::holds_alternative<Configuration>(parsed)) << error_of(toml);
  return std::holds_alternative<Configuration>(parsed) ? std::get<Configuration>(parsed).engine
                                                       : EngineOptions{};
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(Tuning, EachMemberOfEachGroupIsListedOnceWithUnitAndMeaning) {
  EngineOptions options;
  options.visit_tuning([](const std::string& name, auto& group) {
    std::set<const void*> members;
    std::set<std::string> names;
    group.visit_options(
        [&](auto& value, const char* key, const OptionUnit& option_unit, const std::string& meaning) {
          const std::string unit = option_unit.text;
          EXPECT_TRUE(members.insert(&value).second) << name << "." << key;
          EXPECT_TRUE(names.insert(key).second) << name << "." << key;
          EXPECT_FALSE(unit.empty() || contains(unit, ":")) << name << "." << key;
          EXPECT_EQ(unit == "share", option_unit.max == 1) << name << "." << key << ": use share_unit";
          EXPECT_FALSE(meaning.empty() || contains(meaning, "\n")) << name << "." << key;
          const auto* at = reinterpret_cast<const char*>(&value);
          const auto* begin = reinterpret_cast<const char*>(&group);
          EXPECT_TRUE(at >= begin && at < begin + sizeof group) << name << "." << key;
        });
    std::size_t copies = 0;
    if constexpr (requires { group.common; }) copies = 1;  // listed once, as "common"
    EXPECT_EQ(members.size() + copies, members_of<std::remove_reference_t<decltype(group)>>()) << name;
  });
}

TEST(Tuning, EachGroupOfTheOptionsIsListedOnce) {
  constexpr std::size_t for_users =
      6;  // of [engine] and [limits]; "normals" and "outline" are within one of these
  EngineOptions options;
  std::set<const void*> groups;
  std::set<std::string> names;
  options.visit_tuning([&](const std::string& name, auto& group) {
    EXPECT_TRUE(groups.insert(&group).second) << name;
    EXPECT_TRUE(names.insert(name).second) << name;
  });
  EXPECT_EQ(groups.size() - 2 + for_users, members_of<EngineOptions>());
}

TEST(Tuning, WhatIsListedReadsAsTheDefaults) {
  const std::string text = tuning_text({});
  EXPECT_EQ(tuning_text(options_of(text)), text);
}

TEST(Tuning, AValueReachesItsMemberAndNoOther) {
  const std::string defaults = tuning_text({});
  const std::string text =
      tuning_text(options_of("[tuning]\ntrial.min_way_m = 17.5\n[tuning.match]\nmin_pairs = 9\n"));
  EXPECT_TRUE(contains(text, "trial.min_way_m = 17.5\n"));
  EXPECT_TRUE(contains(text, "match.min_pairs = 9\n"));
  std::string put_back = text;
  put_back.replace(put_back.find("min_way_m = 17.5"), 16, "min_way_m = 15.0");
  put_back.replace(put_back.find("min_pairs = 9"), 13, "min_pairs = 12");
  EXPECT_EQ(put_back, defaults);
}

TEST(Tuning, AProbabilityBecomesABoundOfItsDegreesOfFreedom) {
  const EngineOptions options = options_of("[tuning]\ntrial.max_jump = 0.95\n");
  EXPECT_EQ(options.trial.max_jump.bound(3), chi2_quantile(0.95, 3));
}

TEST(Tuning, OfWhatIsCommonReachesAllThatHoldACopy) {
  EngineOptions options = options_of("[tuning]\ncommon.surprise = 0.95\ncommon.lever_m = 4\n");
  int copies = 0;
  options.visit_tuning([&](const std::string& name, auto& group) {
    if constexpr (requires { group.common; }) {
      ++copies;
      EXPECT_EQ(group.common.surprise.probability(), 0.95) << name;
      EXPECT_EQ(group.common.lever_m, 4) << name;
    }
  });
  EXPECT_GT(copies, 0);
}

TEST(Tuning, UnknownKeysAreErrorsThatNameFileAndLine) {
  EXPECT_TRUE(error_of("[tuning]\n\nmatch.sigma = 1\n")
                  .starts_with("test.toml:3: unknown key 'sigma' in [tuning.match]"));
  EXPECT_TRUE(error_of("[tuning]\nmatching.sigma_m = 1\n")
                  .starts_with("test.toml:2: unknown key 'matching' in [tuning]"));
}

TEST(Tuning, WrongTypesAreErrors) {
  EXPECT_TRUE(
      contains(error_of("[tuning]\nmatch.sigma_m = \"0.03\"\n"), "test.toml:2: sigma_m must be a number"));
  EXPECT_TRUE(contains(error_of("[tuning]\nmatch.min_pairs = 12.5\n"), "min_pairs must be an integer"));
  EXPECT_TRUE(contains(error_of("[tuning]\nmatch = 3\n"), "match must be a table"));
}

TEST(Tuning, NumbersThatAreNotFiniteOrFarFromTheDefaultAreErrors) {
  for (const char* value : {"nan", "inf", "-inf", "-0.03", "0", "31", "0.00002"})
    EXPECT_TRUE(contains(error_of(std::string("[tuning]\nmatch.sigma_m = ") + value), "is not within"))
        << value;
  for (const char* value : {"0", "-1", "12001"})
    EXPECT_TRUE(contains(error_of(std::string("[tuning]\nmatch.min_pairs = ") + value), "is not within"))
        << value;
  EXPECT_TRUE(contains(error_of("[tuning]\nlocalise.min_score = 1.01"), "is not within"));
  for (const char* value : {"0", "1", "-0.5", "nan"})
    EXPECT_TRUE(contains(error_of(std::string("[tuning]\ntrial.max_jump = ") + value), "is not within"))
        << value;
}

}  // namespace
}  // namespace isthmus
