#pragma once

#include <string>
#include <vector>

namespace isthmus {

/// Before any work is done for it: a file that is to be written. Throws std::runtime_error where it holds
/// something already and `force` does not say that this may go.
void check_new_file(const std::string& file, bool force);

/// The same for a directory, which is made where it is missing. Throws std::runtime_error where nothing can
/// be written into it, or where it holds results (a report.json) and `force` does not say that they may go.
void check_new_directory(const std::string& directory, bool force);

/// The same for files whose names end so (".png") that are to be written into a directory, which may hold
/// others, and may be missing.
void check_new_files_in(const std::string& directory, const std::vector<std::string>& endings, bool force);

}  // namespace isthmus
