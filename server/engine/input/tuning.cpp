#include "server/engine/input/tuning.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <concepts>
#include <cstdint>
#include <limits>
#include <type_traits>

namespace isthmus {
namespace {

constexpr double max_factor = 1000;
constexpr double min_tail = 1e-9;  // of a probability

/// Reads the values of one group.
struct GroupReader {
  Fields& fields;

  void operator()(double& value, const char* name, const OptionUnit& unit, const char*) const {
    const double max = value > 0 ? value * max_factor : max_factor;
    fields.read_within(name, value, value / max_factor, std::min(unit.max, max));
  }

  void operator()(ChiSquaredTest& test, const char* name, const OptionUnit&, const char*) const {
    double probability = test.probability();
    fields.read_within(name, probability, min_tail, 1 - min_tail);
    test = ChiSquaredTest(probability);
  }

  template <std::integral Integer>
  void operator()(Integer& value, const char* name, const OptionUnit&, const char*) const {
    const auto given = static_cast<std::int64_t>(value);
    constexpr auto factor = static_cast<std::int64_t>(max_factor);
    constexpr std::int64_t max = std::min<std::uint64_t>(std::numeric_limits<Integer>::max(),
                                                         std::numeric_limits<std::int64_t>::max());
    fields.read_within(name, value, std::max<std::int64_t>(1, given / factor), std::min(given * factor, max));
  }
};

/// The shortest text that reads as the same number; one of a real number as TOML has it, "3.0".
template <class Number>
std::string number_text(Number number) {
  std::array<char, 32> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), number).ptr;
  std::string written(text.data(), end);
  if (std::is_floating_point_v<Number> && written.find_first_of(".e") == std::string::npos) written += ".0";
  return written;
}

std::string number_text(const ChiSquaredTest& test) { return number_text(test.probability()); }

}  // namespace

void read_tuning(const Setting& table, EngineOptions& options) {
  Fields groups(table, " in [tuning]");
  options.visit_tuning([&](const std::string& name, auto& group) {
    const Setting* given = groups.table(name);
    if (given == nullptr) return;
    Fields fields(*given, " in [tuning." + name + "]");
    group.visit_options(GroupReader{fields});
    fields.finish();
  });
  groups.finish();
  options.share_common();
}

std::string tuning_text(EngineOptions options) {
  std::string text = "[tuning]\n";
  options.visit_tuning([&](const std::string& group_name, auto& group) {
    group.visit_options(
        [&](const auto& value, const std::string& name, const OptionUnit& unit, const char* meaning) {
          text += std::string("# ") + unit.text + ": " + meaning + "\n" + group_name + "." + name + " = " +
                  number_text(value) + "\n";
        });
  });
  return text;
}

}  // namespace isthmus
