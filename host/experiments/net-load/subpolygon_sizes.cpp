#include "host/experiments/net-load/subpolygon_sizes.h"

#include <fmt/core.h>

#include <algorithm>

#include "host/files/json.h"
#include "host/instrument/simulator.h"
#include "protocol/messages.h"

namespace rayfarm {
namespace {

constexpr double kThesisPixels = 1024.0 * 1024.0;

/// Bytes a pixel of a render's results, and of results and control messages together.
struct Weight {
  double results = 0, all = 0;
};

Weight weigh(const LocalRuns& runs, const std::string& scene, int width_px, int side_px, Wire wire,
             bool compresses) {
  RenderOptions job =
      runs.job(scene, fmt::format("size-{}-{}-{}", side_px, int(wire), int(compresses)), width_px);
  job.policy = AssignmentPolicy::interleaved;
  job.wire = wire;
  job.compresses = compresses;
  job.least_side_px = side_px;
  job.subpolygons_per_processor = 1 << 20;  // as many as there is room for
  job.local_nodes = 2;
  runs.render(job);
  const JsonView traffic = JsonView::read_file(job.stats).at("traffic");
  const double pixels = double(width_px) * (width_px * 3 / 4);
  const double results = traffic.at(name_of(Command::return_result)).at("bytes").number() / pixels;
  return {results, results + traffic.at("control").at("bytes").number() / pixels};
}

/// From how many processors on 64 subpolygons each leave fewer than so many pixels of the thesis's picture.
double processors_for(double pixels) {
  return kThesisPixels / (kSubpolygonsPerProcessor * pixels);
}

}  // namespace

std::vector<SizeRun> measure_sizes(const LocalRuns& runs, const std::string& scene, int width_px) {
  std::vector<SizeRun> sizes;
  for (const int side : {1, 2, 4, 8, 16, 32}) {
    tell_net_load(fmt::format("subpolygons of {} x {} pixels", side, side));
    const Weight pixel = weigh(runs, scene, width_px, side, Wire::pixel, true),
                 block = weigh(runs, scene, width_px, side, Wire::block, false),
                 compressed = weigh(runs, scene, width_px, side, Wire::block, true);
    sizes.push_back({side, pixel.results, pixel.all, block.results, block.all, compressed.results});
  }
  return sizes;
}

std::string sizes_text(const std::vector<SizeRun>& sizes) {
  std::string text =
      "\n## How small a subpolygon may be\n\nReal renders without a net, in the smallest subpolygons that "
      "`--least-side` leaves. A block has one header (command, form, report); the pixel wire's pixels have 9 "
      "bytes each, "
      "and its reports travel beside them as control messages, which the thesis has not. N: the processors "
      "for which 64 N subpolygons of 1024 × 1024 pixels have this size.\n\n"
      "| side | N | pixel wire | with control | block wire | with control | header of a block | compressed "
      "|\n"
      "|---:|---:|---:|---:|---:|---:|---:|---:|\n";
  for (const SizeRun& s : sizes)
    text += fmt::format("| {} | {:.0f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.1f} | {:.2f} |\n", s.side_px,
                        processors_for(s.side_px * s.side_px), s.pixel_wire, s.pixel_wire_all, s.block,
                        s.block_all, s.header(), s.compressed);
  const double header = sizes.front().header(), loses = header / (double(kPixelBytes) - 3), half = header / 3;
  const bool is_ever_lighter = std::any_of(sizes.begin(), sizes.end(),
                                           [](const SizeRun& s) { return s.pixel_wire_all < s.block_all; });
  text += fmt::format(
      "\nA block of n pixels weighs {0:.1f} + 3 n bytes, the pixel wire 9 n: blocks lose from {1:.1f} pixels "
      "down, which "
      "64 N subpolygons of the thesis's picture have from N = {2:.0f} on. From N = {3:.0f} on ({4:.1f} "
      "pixels) more than half "
      "of a block is header. With its reports counted the pixel wire is {5}. Bytes are not all: the "
      "simulator, with the thesis's picture and net and 64 N subpolygons of any size or of at least 8 × 8 "
      "pixels:\n\n"
      "| wire | least side | processors | bytes a pixel | frame, s | efficiency "
      "|\n|---|---:|---:|---:|---:|---:|\n",
      header, loses, processors_for(loses), processors_for(half), half,
      is_ever_lighter ? "lighter for the smallest alone" : "lighter for none of these sizes");
  for (const int processors : {1024, 4444, 8192, 16383})
    for (const auto& [name, form, side] :
         {std::tuple{"pixel", ResultForm::pixels, 1}, std::tuple{"block", ResultForm::blocks, 1},
          std::tuple{"block", ResultForm::blocks, 8}}) {
      Simulation s;
      s.processors = processors;
      s.form = form;
      s.least_side_px = side;
      s.messages_held = 2;
      const SimulationResult r = simulate(s);
      text += fmt::format("| {} | {} | {} | {:.2f} | {:.2f} | {:.2f} |\n", name, side, processors,
                          r.bytes / kThesisPixels, r.frame_s, r.efficiency);
    }
  return text;
}

}  // namespace rayfarm
