#include "host/experiments/working-sets/working_sets.h"

#include <fmt/core.h>
#include <sys/mman.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <optional>
#include <utility>

#include "common/compile/compile.h"
#include "common/lighting/renderer.h"
#include "common/scene/scene_block.h"
#include "host/experiments/page.h"
#include "host/experiments/working-sets/terrain.h"
#include "host/files/text_file.h"
#include "host/instrument/table.h"
#include "host/process/exit_code.h"
#include "protocol/subpolygons.h"

namespace rayfarm {
namespace {

/// The thesis traces a ray in 0.04 s, and looks at intervals of 10 and 60 s.
constexpr int kRaysPerInterval = 250, kIntervalsPerMinute = 6;
constexpr int kSide_px = 256;       ///< of the picture, as in the thesis
constexpr int kTerrainCells = 708;  ///< a side: 1,002,528 triangles

constexpr const char* kNotMeasured = "-";

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

/// What this program's code takes, and which of it has been executed since it was last told to forget: by the
/// kernel's bits for referenced pages.
class WatchedCode {
 public:
  /// Bytes of the whole, and of the pages referenced; empty where the kernel doesn't tell.
  struct Pages {
    double size = 0, referenced = 0;
  };
  void forget() const { std::ofstream("/proc/self/clear_refs") << "1"; }
  std::optional<Pages> read() const {
    std::ifstream maps("/proc/self/smaps");
    const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
    bool is_code = false;
    Pages pages;
    for (std::string line; std::getline(maps, line);) {
      const std::string first = line.substr(0, line.find(' '));
      if (!first.ends_with(':')) {  // a mapping's range of addresses; what follows tells of it
        if (is_code) return pages;
        is_code = line.find(" r-xp ") != std::string::npos && line.ends_with(program);
      }
      if (!is_code) continue;
      if (line.starts_with("Size:")) pages.size = 1024 * std::atof(line.c_str() + 5);
      if (line.starts_with("Referenced:")) pages.referenced = 1024 * std::atof(line.c_str() + 11);
    }
    return std::nullopt;
  }
};

struct WorkingSet {
  double active_bytes = 0;          ///< touched in an interval, mean
  double new_bytes_per_minute = 0;  ///< touched for the first time in six intervals, mean
  std::optional<double> code_bytes, active_code_bytes;
  double active_raster_bytes = 0;
};

/// Pages of a raster of 3 bytes a pixel, as far as pixels of a rectangle lie in it. It is stored column by
/// column, as the thesis traces it.
void touch_raster(const PixelRect& rect, int side_px, std::vector<char>& pages, size_t page_bytes) {
  for (int x = rect.x0; x < rect.x1; ++x)
    for (int y = rect.y0; y < rect.y1; ++y)
      pages[3 * (static_cast<size_t>(x) * static_cast<size_t>(side_px) + static_cast<size_t>(y)) /
            page_bytes] = 1;
}

/// Renders the rectangles one after the other.
WorkingSet measure(std::span<const std::byte> block, const RenderSettings& settings, int frame,
                   const std::vector<PixelRect>& order) {
  WatchedMemory memory(block);
  const WatchedCode code;
  Renderer renderer(decode_scene(memory.bytes(block.size())), settings);
  renderer.render(frame, order.front(), [] {});  // what is set up for a frame is not tracing
  memory.close();
  const auto page = static_cast<double>(memory.page_bytes());
  const auto count = [](const std::vector<char>& v) {
    return static_cast<double>(std::count(v.begin(), v.end(), 1));
  };
  std::vector<char> known, minute, raster(3 * settings.crop.area() / memory.page_bytes() + 1, 0);
  WorkingSet result;
  int intervals = 0, minutes = 0, pixels = 0;
  double new_bytes = 0;
  code.forget();
  for (const PixelRect& rect : order) {
    renderer.render(frame, rect, [] {});
    touch_raster(rect, settings.crop.width(), raster, memory.page_bytes());
    pixels += static_cast<int>(rect.area());
    if (pixels < kRaysPerInterval) continue;
    pixels = 0;
    if (const auto pages = code.read()) {
      result.code_bytes = pages->size;
      result.active_code_bytes = result.active_code_bytes.value_or(0) + pages->referenced;
    }
    const std::vector<char> touched = memory.close();
    ++intervals;
    result.active_bytes += page * count(touched);
    result.active_raster_bytes += page * count(std::exchange(raster, std::vector<char>(raster.size(), 0)));
    minute.resize(touched.size(), 0);
    for (size_t i = 0; i < touched.size(); ++i) minute[i] = static_cast<char>(minute[i] | touched[i]);
    if (intervals % kIntervalsPerMinute == 0) {
      if (!known.empty()) {
        for (size_t i = 0; i < minute.size(); ++i) new_bytes += minute[i] && !known[i] ? page : 0;
        ++minutes;
      }
      known = std::exchange(minute, {});
    }
    code.forget();
  }
  const int n = std::max(1, intervals);
  result.active_bytes /= n;
  result.active_raster_bytes /= n;
  if (result.active_code_bytes) *result.active_code_bytes /= n;
  result.new_bytes_per_minute = new_bytes / std::max(1, minutes);
  return result;
}

/// The image as pieces of a few rays, in several orders. The thesis's: "starting at the lower left of the
/// display and proceeding up the display on a single x subpixel line", then the next line to the right.
std::vector<PixelRect> columns_upwards(int side_px) {
  std::vector<PixelRect> order;
  for (int x = 0; x < side_px; ++x)
    for (int y = side_px; y > 0; y -= 8) order.push_back({x, std::max(0, y - 8), x + 1, y});
  return order;
}
std::vector<PixelRect> subpolygons(int side_px, int processors, int processor) {
  const SubpolygonGrid grid = make_grid(0, 0, side_px, side_px, processors);
  std::vector<PixelRect> order;
  for (const SubpolygonId i : interleaved_set(grid, SetPattern::lattice, processors, processor)) {
    const DisplayPolygon p = grid.polygon(i);
    for (int y = p.top; y <= p.bottom; ++y) order.push_back({p.left, y, p.right + 1, y + 1});
  }
  return order;
}
std::vector<PixelRect> shuffled(int side_px) {
  std::vector<PixelRect> order = columns_upwards(side_px), result(order.size());
  for (uint32_t i = 0; i < order.size(); ++i)
    result[permuted(i, static_cast<uint32_t>(order.size()), 1)] = order[i];
  return result;
}

struct TestScene {
  std::string name, path;
};

/// The thesis's three images, and two scenes that are larger than its memory.
std::vector<TestScene> prepare_scenes(const ExperimentOptions& options, int side_px) {
  const std::filesystem::path given(options.scenes), made = std::filesystem::path(options.output) / "scenes";
  make_page_folder(made.string());
  const int cells = std::max(1, kTerrainCells * side_px / kSide_px);
  const std::string terrain = (made / "terrain.yaml").string();
  write_terrain(terrain, cells);
  const std::filesystem::path images = given / "hierarchies";
  return {{"Image 1", (images / "beach_house.yaml").string()},
          {"Image 2", (images / "primitives.yaml").string()},
          {"Image 3", (images / "plant.yaml").string()},
          {fmt::format("{} triangles", 2 * cells * cells), terrain},
          {"rainbow.yaml", (given / "rainbow.yaml").string()}};
}

TableCell bytes_or_dash(const std::optional<double>& bytes) {
  return bytes ? TableCell(*bytes) : TableCell(std::string(kNotMeasured));
}

std::string text_of(const TableCell& cell) {
  return std::holds_alternative<double>(cell) ? fmt::format("{:.0f}", std::get<double>(cell))
                                              : std::get<std::string>(cell);
}

std::string page_text(const Table& table, int side_px) {
  std::string page = fmt::format(
      "# Working sets: Table 4.12\n\nWritten by `rayfarm experiment working-sets`. Active memory is the "
      "pages that "
      "were touched while 250 eye rays were traced, Whitted's model, {0} × {0} pixels: ten of the thesis's "
      "seconds; "
      "new pages are those of the scene touched in 1,500 rays and not in the 1,500 before.\n\n"
      "As in the thesis totals are the sum of the scene (here its block, with lights and materials), the "
      "program's "
      "code (here that of the whole of Rayfarm, every lighting model, loader and command for several SIMD "
      "targets) "
      "and the raster of 3 bytes a pixel. Active code is what the kernel marks as referenced. `columns from "
      "the lower "
      "left` is the thesis's order; the raster lies column by column.\n\n"
      "Images 1 to 3 are rebuilt in `scenes/hierarchies/`, with places, views and lights of ours; the "
      "terrain "
      "lies in `scenes/` beside this page after a run.\n\n"
      "| the thesis | total | active | share |\n|---|---:|---:|---:|\n"
      "| Image 1 | 654404 | 73281 | 11.2 % |\n| Image 2 | 417716 | 66332 | 15.9 % |\n"
      "| Image 3 | 818148 | 101918 | 12.5 % |\n\nand 10K bytes of new pages in 60 s.\n\n"
      "| scene | order | total | active | scene | active | share | code | active | active raster | new in "
      "1,500 rays "
      "|\n|---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n",
      side_px);
  for (const auto& row : table.rows)
    page += fmt::format("| {} | {} | {} | {} | {} | {} | {:.1f} % | {} | {} | {} | {} |\n", text_of(row[0]),
                        text_of(row[1]), text_of(row[9]), text_of(row[10]), text_of(row[2]), text_of(row[3]),
                        100 * std::get<double>(row[4]), text_of(row[6]), text_of(row[7]), text_of(row[8]),
                        text_of(row[5]));
  return page;
}

}  // namespace

int run_working_set_experiment(const ExperimentOptions& options) {
  const std::filesystem::path folder = make_page_folder(options.output);
  const int side_px = options.width_px > 0 ? options.width_px : kSide_px;
  Table table{"working sets",
              {"scene", "order", "block_bytes", "active_bytes", "active_share", "new_bytes_per_minute",
               "code_bytes", "active_code_bytes", "active_raster_bytes", "total_bytes", "active_total_bytes"},
              {}};
  for (const TestScene& scene : prepare_scenes(options, side_px)) {
    const CompiledScene compiled = compile(load_scene(scene.path));
    RenderSettings settings;
    settings.width_px = settings.height_px = side_px;
    settings.crop = {0, 0, side_px, side_px};
    const std::pair<const char*, std::vector<PixelRect>> orders[] = {
        {"columns from the lower left", columns_upwards(side_px)},
        {"subpolygons of 1 processor", subpolygons(side_px, 1, 0)},
        {"subpolygons of 1 of 16 processors", subpolygons(side_px, 16, 0)},
        {"pieces of columns, shuffled", shuffled(side_px)}};
    for (const auto& [order, rects] : orders) {
      const WorkingSet set = measure(compiled.block.bytes(), settings, 0, rects);
      const auto page = static_cast<size_t>(sysconf(_SC_PAGESIZE));
      const auto size = static_cast<double>((compiled.block.size + page - 1) / page * page);
      const double raster = 3.0 * side_px * side_px;
      std::optional<double> total, active;
      if (set.code_bytes) {
        total = size + *set.code_bytes + raster;
        active = set.active_bytes + *set.active_code_bytes + set.active_raster_bytes;
      }
      table.rows.push_back({scene.name, std::string(order), size, set.active_bytes, set.active_bytes / size,
                            set.new_bytes_per_minute, bytes_or_dash(set.code_bytes),
                            bytes_or_dash(set.active_code_bytes), set.active_raster_bytes,
                            bytes_or_dash(total), bytes_or_dash(active)});
    }
  }
  if (std::holds_alternative<std::string>(table.rows.front()[6]))
    fmt::print(
        stderr,
        "rayfarm: this kernel doesn't tell which code is used (/proc/self/smaps, clear_refs): the page "
        "has no totals\n");
  fmt::print("{}", format_tables({table}, TableFormat::text));
  write_text_file((folder / "working_sets.csv").string(), format_tables({table}, TableFormat::csv));
  write_text_file((folder / "README.md").string(), page_text(table, side_px));
  fmt::print("{}\n", (folder / "README.md").string());
  return kComplete;
}

}  // namespace rayfarm
