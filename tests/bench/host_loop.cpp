// What the host's loop takes for a message, by the number of nodes: the real host on local transports, and
// one thread that plays all nodes. They return blocks of 32 × 32 pixels of a rendered picture, compressed
// before, as soon as they are asked to: the host is what everybody waits for.
//   host_loop SCENE [NODES ...]      default: 10 100 1000 10000
#include <fmt/core.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <thread>
#include <vector>

#include "common/compile/compile.h"
#include "common/lighting/renderer.h"
#include "host/farm/farm_host.h"
#include "protocol/block_codec.h"
#include "protocol/clock.h"
#include "protocol/local_transport.h"

namespace {

using namespace rayfarm;

constexpr int kBlock_px = 32, kSide_px = 4096, kFrames = 2;

/// A picture of the scene, as nodes send its blocks.
std::vector<Bytes> compressed_blocks(const std::string& path) {
  const CompiledScene compiled = compile(load_scene(path));
  RenderSettings settings;
  settings.width_px = 20 * kBlock_px;
  settings.height_px = 15 * kBlock_px;
  settings.crop = {0, 0, settings.width_px, settings.height_px};
  settings.pixel_format = PixelFormat::rgb8;
  Renderer renderer(compiled.scene, settings);
  std::vector<Bytes> blocks;
  for (int y = 0; y < settings.height_px; y += kBlock_px)
    for (int x = 0; x < settings.width_px; x += kBlock_px)
      blocks.push_back(compress_rgb8(renderer.render(1, {x, y, x + kBlock_px, y + kBlock_px}, [] {}).pixels,
                                     kBlock_px, kBlock_px));
  return blocks;
}

/// Plays the nodes until the host dismisses them.
void play_nodes(const std::vector<std::unique_ptr<Transport>>& ends, const JobPlan& plan,
                const std::vector<Bytes>& blocks, double& used_s) {
  std::vector<StepIndex> steps(ends.size());
  const PicturesPhase& pictures = plan.pictures;
  bool is_over = false;
  while (!is_over) {
    bool is_idle = true;
    for (size_t i = 1; i < ends.size(); ++i)
      while (const auto message = ends[i]->try_receive()) {
        is_idle = false;
        if (message->channel == Channel::control) {
          const Control control = decode_control(message->bytes);
          if (const auto* select = std::get_if<SelectStep>(&control)) steps[i] = select->step;
          is_over |= std::holds_alternative<Finish>(control);
        } else if (command_of(message->bytes) == Command::load_display_polygon) {
          const SubpolygonId subpolygon = *pictures.grid.find(decode_display_polygon(message->bytes));
          BlockResult block{{pictures.frames[steps[i].place()], subpolygon, {1024, 2048, 1024}, 5000, true},
                            true,
                            blocks[subpolygon.place() % blocks.size()]};
          ends[i]->send(kHost, Channel::command, encode_block(processor_of(NodeId(int(i))), block));
        }
      }
    if (is_idle) std::this_thread::yield();
  }
  used_s = thread_cpu_s();
}

void measure(int nodes, const std::vector<Bytes>& blocks, const std::filesystem::path& folder) {
  const auto ends = make_local_transports(nodes);
  FarmHostOptions options;
  JobPlan& plan = options.plan;
  plan.processors = nodes;
  plan.pictures.grid = {0, 0, kSide_px, kSide_px, kSide_px / kBlock_px, kSide_px / kBlock_px};
  options.image = {kSide_px, kSide_px, {0, 0, kSide_px, kSide_px}, make_pixel_layout(PixelFormat::rgb8), {}};
  options.progress = ProgressStyle::none;
  JobResult result;
  for (int i = 1; i <= nodes; ++i) {
    result.nodes.push_back({});
    result.nodes.back().id = NodeId(i);
  }
  for (int i = 1; i <= kFrames; ++i) {
    plan.pictures.frames.emplace_back(i);
    options.files.push_back(folder / fmt::format("{}.png", i));
  }
  double nodes_used_s = 0;
  std::thread all_nodes([&] { play_nodes(ends, plan, blocks, nodes_used_s); });
  const double process_s = cpu_s(), loop_s = thread_cpu_s();
  {
    FarmHost host(*ends[0], options, result,
                  [](const std::string& text) { fmt::print(stderr, "{}\n", text); });
    host.run();
  }
  const double loop = thread_cpu_s() - loop_s, trace_s = result.times.trace_s;
  ends[0]->broadcast(Channel::control, encode_control(Finish{}));
  all_nodes.join();
  const double host = cpu_s() - process_s - nodes_used_s;
  if (result.frames_failed() > 0) std::exit(1);
  const auto each = static_cast<double>(result.duplicates) + double(kFrames) * plan.pictures.grid.count();
  fmt::print("{:>8} {:12.0f} {:14.0f} {:14.1f} {:14.1f} {:14.1f}\n", nodes, each, each / trace_s,
             1e6 * loop / each, 1e6 * host / each, 1e-6 * double(result.pixels_received) / trace_s);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    fmt::print(stderr, "host_loop SCENE [NODES ...]\n");
    return 2;
  }
  const std::vector<Bytes> blocks = compressed_blocks(argv[1]);
  size_t bytes = 0;
  for (const Bytes& block : blocks) bytes += block.size();
  fmt::print("{} blocks of {} pixels, {:.0f} bytes each\n", blocks.size(), kBlock_px * kBlock_px,
             static_cast<double>(bytes) / static_cast<double>(blocks.size()));
  std::vector<int> counts;
  for (int i = 2; i < argc; ++i) counts.push_back(std::atoi(argv[i]));
  if (counts.empty()) counts = {10, 100, 1000, 10000};
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("host_loop.{}", getpid());
  std::filesystem::create_directories(folder);
  fmt::print("{:>8} {:>12} {:>14} {:>14} {:>14} {:>14}\n", "nodes", "messages", "messages/s", "us, the loop",
             "us, all threads", "Mpixel/s");
  for (const int nodes : counts) measure(nodes, blocks, folder);
  std::filesystem::remove_all(folder);
}
