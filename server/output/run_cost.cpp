#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <fstream>

#include "server/output/output.hpp"

namespace isthmus {

void share_memory_among_threads() { ::mallopt(M_ARENA_MAX, 1); }

double process_cpu_s() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const auto total_s = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return total_s(usage.ru_utime) + total_s(usage.ru_stime);
}

double process_peak_rss_mb() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024;  // Linux counts in KiB
}

double process_rss_mb() {
  std::ifstream file("/proc/self/statm");
  double all_pages = 0, resident_pages = 0;
  if (!(file >> all_pages >> resident_pages)) return 0;
  return resident_pages * static_cast<double>(::sysconf(_SC_PAGESIZE)) / (1024 * 1024);
}

}  // namespace isthmus
