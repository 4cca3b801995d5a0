#pragma once

#include <CLI/CLI.hpp>
#include <cmath>
#include <string>

namespace isthmus {

/// For options that take numbers: CLI11's ranges let "nan" through, as it is neither below nor above.
inline const CLI::Validator finite_number(
    [](std::string& text) {
      double value = 0;
      const bool finite = CLI::detail::lexical_cast(text, value) && std::isfinite(value);
      return finite ? std::string() : "'" + text + "' is not a finite number";
    },
    "FINITE");

}  // namespace isthmus
