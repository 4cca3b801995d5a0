#include "server/output/format/atomic_file.hpp"
#include "server/output/format/csv.hpp"
#include "server/output/format/tum.hpp"
#include "tools/import/mrclam.hpp"
#include "tools/text/lines.hpp"

namespace isthmus {
namespace {

void write_tum(const std::vector<TruthLine>& lines, const std::string& path) {
  AtomicFile file(path);
  for (const auto& [utime, pose] : lines) file.write(tum_line(utime, pose));
  file.commit();
}

void write_tags(const std::map<int, Eigen::Vector2d>& landmarks, const std::map<int, std::int32_t>& barcodes,
                const std::string& barcode_file, const std::string& path) {
  CsvFile csv(path, "barcode,x_m,y_m");
  for (const auto& [subject, position] : landmarks) {
    const auto barcode = barcodes.find(subject);
    if (barcode == barcodes.end()) {
      throw FileError(barcode_file, 0, "no barcode of subject " + std::to_string(subject));
    }
    csv.row(barcode->second, position.x(), position.y());
  }
  csv.commit();
}

}  // namespace

void write_mrclam_truth(const std::string& directory, const std::string& truth_directory) {
  const std::string barcode_file = mrclam_file(directory, "Barcodes");
  const auto landmarks = read_landmark_truth(mrclam_file(directory, "Landmark_Groundtruth"));
  std::map<int, std::vector<TruthLine>> robots;
  for (const int subject : mrclam_robots(directory)) {
    const std::string name = "Robot" + std::to_string(subject) + "_Groundtruth";
    robots[subject] = read_robot_truth(mrclam_file(directory, name));
  }
  make_directory(truth_directory);
  for (const auto& [subject, lines] : robots) {
    write_tum(lines, truth_directory + "/R" + std::to_string(subject) + ".tum");
  }
  write_tags(landmarks, read_barcodes(barcode_file), barcode_file, truth_directory + "/tags.csv");
}

}  // namespace isthmus
