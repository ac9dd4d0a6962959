#include "host/experiments/working-sets/working_sets.h"

#include <fmt/core.h>
#include <sys/mman.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <filesystem>
#include <utility>

#include "common/compile/compile.h"
#include "common/lighting/renderer.h"
#include "common/scene/scene_block.h"
#include "host/files/text_file.h"
#include "host/instrument/table.h"
#include "host/process/exit_code.h"
#include "protocol/subpolygons.h"

namespace rayfarm {
namespace {

/// The thesis traces a ray in 0.04 s, and looks at intervals of 10 and 60 s.
constexpr int kRaysPerInterval = 250, kIntervalsPerMinute = 6;
constexpr int kSide_px = 256;  ///< of the picture, as in the thesis

/// Memory that tells which of its pages were read since it was last closed.
class WatchedMemory {
 public:
  explicit WatchedMemory(std::span<const std::byte> bytes)
      : page_(static_cast<size_t>(sysconf(_SC_PAGESIZE))), size_((bytes.size() + page_ - 1) / page_ * page_) {
    data_ = static_cast<std::byte*>(
        mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0));
    if (data_ == MAP_FAILED) throw std::bad_alloc();
    std::memcpy(data_, bytes.data(), bytes.size());
    touched_.assign(size_ / page_, 0);
    watched = this;
    struct sigaction action {};
    action.sa_sigaction = [](int, siginfo_t* info, void*) { watched->open(info->si_addr); };
    action.sa_flags = SA_SIGINFO;
    sigaction(SIGSEGV, &action, &before_);
  }
  WatchedMemory(const WatchedMemory&) = delete;
  ~WatchedMemory() {
    sigaction(SIGSEGV, &before_, nullptr);
    watched = nullptr;
    munmap(data_, size_);
  }
  std::span<const std::byte> bytes(size_t size) const { return {data_, size}; }
  size_t page_bytes() const { return page_; }

  /// Closes all pages again; 1 for each that was touched.
  std::vector<char> close() {
    std::vector<char> touched(touched_.size(), 0);
    touched.swap(touched_);
    mprotect(data_, size_, PROT_NONE);
    return touched;
  }

 private:
  /// In a signal handler: opens the page, or lets the fault happen again as what it is.
  void open(void* address) {
    const auto offset = static_cast<size_t>(static_cast<std::byte*>(address) - data_);
    if (address < data_ || offset >= size_) {
      sigaction(SIGSEGV, &before_, nullptr);
      return;
    }
    touched_[offset / page_] = 1;
    mprotect(data_ + offset / page_ * page_, page_, PROT_READ);
  }

  static WatchedMemory* watched;
  size_t page_, size_;
  std::byte* data_ = nullptr;
  std::vector<char> touched_;
  struct sigaction before_ {};
};
WatchedMemory* WatchedMemory::watched = nullptr;

struct WorkingSet {
  double active_bytes = 0;          ///< touched in an interval, mean
  double new_bytes_per_minute = 0;  ///< touched for the first time in six intervals, mean
};

/// Renders the rectangles one after the other.
WorkingSet measure(std::span<const std::byte> block, const RenderSettings& settings, int frame,
                   const std::vector<PixelRect>& order) {
  WatchedMemory memory(block);
  Renderer renderer(decode_scene(memory.bytes(block.size())), settings);
  renderer.render(frame, order.front(), [] {});  // what is set up for a frame is not tracing
  memory.close();
  std::vector<char> known, minute;
  WorkingSet result;
  int intervals = 0, minutes = 0, pixels = 0;
  double new_bytes = 0;
  const auto page = static_cast<double>(memory.page_bytes());
  for (const PixelRect& rect : order) {
    renderer.render(frame, rect, [] {});
    pixels += static_cast<int>(rect.area());
    if (pixels < kRaysPerInterval) continue;
    pixels = 0;
    const std::vector<char> touched = memory.close();
    ++intervals;
    result.active_bytes += page * static_cast<double>(std::count(touched.begin(), touched.end(), 1));
    minute.resize(touched.size(), 0);
    for (size_t i = 0; i < touched.size(); ++i) minute[i] = static_cast<char>(minute[i] | touched[i]);
    if (intervals % kIntervalsPerMinute != 0) continue;
    if (!known.empty()) {
      for (size_t i = 0; i < minute.size(); ++i) new_bytes += minute[i] && !known[i] ? page : 0;
      ++minutes;
    }
    known = std::exchange(minute, {});
  }
  result.active_bytes /= std::max(1, intervals);
  result.new_bytes_per_minute = new_bytes / std::max(1, minutes);
  return result;
}

/// The image as rectangles of a few rays, in several orders.
std::vector<PixelRect> rows_upwards() {
  std::vector<PixelRect> order;
  for (int y = kSide_px - 1; y >= 0; --y)
    for (int x = 0; x < kSide_px; x += 8) order.push_back({x, y, x + 8, y + 1});
  return order;
}
std::vector<PixelRect> subpolygons(int processors, int processor) {
  const SubpolygonGrid grid = make_grid(0, 0, kSide_px, kSide_px, processors);
  std::vector<PixelRect> order;
  for (const SubpolygonId i : interleaved_set(grid, SetPattern::lattice, processors, processor)) {
    const DisplayPolygon p = grid.polygon(i);
    for (int y = p.top; y <= p.bottom; ++y) order.push_back({p.left, y, p.right + 1, y + 1});
  }
  return order;
}
std::vector<PixelRect> shuffled() {
  std::vector<PixelRect> order = rows_upwards(), result(order.size());
  for (uint32_t i = 0; i < order.size(); ++i)
    result[permuted(i, static_cast<uint32_t>(order.size()), 1)] = order[i];
  return result;
}

}  // namespace

int run_working_set_experiment(const ExperimentOptions& options) {
  const std::filesystem::path folder(options.output);
  std::filesystem::create_directories(folder);
  Table table{"working sets",
              {"scene", "order", "block_bytes", "active_bytes", "active_share", "new_bytes_per_minute"},
              {}};
  for (const char* name : {"primitives.yaml", "marina.yaml", "animation.yaml", "rainbow.yaml"}) {
    const CompiledScene compiled =
        compile(load_scene((std::filesystem::path(options.scenes) / name).string()));
    RenderSettings settings;
    settings.width_px = settings.height_px = kSide_px;
    settings.crop = {0, 0, kSide_px, kSide_px};
    const std::pair<const char*, std::vector<PixelRect>> orders[] = {
        {"rows, upwards", rows_upwards()},
        {"subpolygons of 1 processor", subpolygons(1, 0)},
        {"subpolygons of 1 of 16 processors", subpolygons(16, 0)},
        {"pieces of rows, shuffled", shuffled()}};
    for (const auto& [order, rects] : orders) {
      const WorkingSet set = measure(compiled.block.bytes(), settings, 0, rects);
      const auto page = static_cast<size_t>(sysconf(_SC_PAGESIZE));
      const auto size = static_cast<double>((compiled.block.size + page - 1) / page * page);
      table.rows.push_back({std::string(name), std::string(order), size, set.active_bytes,
                            set.active_bytes / size, set.new_bytes_per_minute});
    }
  }
  fmt::print("{}", format_tables({table}, TableFormat::text));
  std::string page =
      "# Working sets: Table 4.12\n\nWritten by `rayfarm experiment working-sets`. Active memory is the "
      "pages of the scene's block that were touched while 250 eye rays were traced, Whitted's model, 256 × "
      "256 pixels: ten of the thesis's seconds; new pages are those touched in 1,500 rays and not in the "
      "1,500 before. The thesis counted all of its process's pages, 73,281 of 654,404 bytes for Image 1 (11 "
      "%), 66,332 of 417,716 for Image 2 (16 %), 101,918 of 818,148 for Image 3 (12 %), and 10K of new pages "
      "in 60 s. The first three scenes here fill a dozen pages or less, so that every ray meets most of "
      "them; the rainbow's 390,625 drops fill 44,000.\n\n";
  page += "| scene | order | block | active | share | new in 1,500 rays |\n|---|---|---:|---:|---:|---:|\n";
  for (const auto& row : table.rows)
    page += fmt::format("| {} | {} | {:.0f} | {:.0f} | {:.1f} % | {:.0f} |\n", std::get<std::string>(row[0]),
                        std::get<std::string>(row[1]), std::get<double>(row[2]), std::get<double>(row[3]),
                        100 * std::get<double>(row[4]), std::get<double>(row[5]));
  write_text_file((folder / "working_sets.csv").string(), format_tables({table}, TableFormat::csv));
  write_text_file((folder / "README.md").string(), page);
  fmt::print("{}\n", (folder / "README.md").string());
  return kComplete;
}

}  // namespace rayfarm
