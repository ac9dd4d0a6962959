#include <fmt/core.h>

#include <cmath>

#include "common/image/image_file.h"
#include "host/commands/commands.h"
#include "host/process/console.h"
#include "host/process/exit_code.h"

namespace rayfarm {
namespace {

struct CompareOptions {
  std::string a, b;
  double tolerance = 0;  ///< largest difference of a channel that counts as equal
  double share = 0;      ///< of pixels that may differ by more, 0 to 1
};

/// kComplete if the images agree within the tolerance, else kRenderFailure.
int compare(const CompareOptions& options) {
  constexpr uint64_t kMostPixels = uint64_t{65536} * 65536;  // of any picture that can be rendered
  ImageReader a(options.a, kMostPixels), b(options.b, kMostPixels);
  if (holds_linear_light(options.a) != holds_linear_light(options.b))
    say("rayfarm: one file holds linear light, the other sRGB: their numbers are compared as they are\n");
  if (a.width_px() != b.width_px() || a.height_px() != b.height_px()) {
    fmt::print("the sizes differ: {}×{} and {}×{}\n", a.width_px(), a.height_px(), b.width_px(),
               b.height_px());
    return kRenderFailure;
  }
  const size_t pixels = static_cast<size_t>(a.width_px()) * static_cast<size_t>(a.height_px());
  size_t differing = 0;
  double largest = 0, squares = 0;
  for (int y = 0; y < a.height_px(); ++y) {
    const std::span<const float> row_a = a.next_row(), row_b = b.next_row();
    for (size_t i = 0; i < row_a.size(); i += 3) {
      bool differs = false;
      for (size_t c = i; c < i + 3; ++c) {
        const double p = static_cast<double>(row_a[c]), q = static_cast<double>(row_b[c]);
        const double d = p == q ? 0 : std::abs(p - q);
        if (!(d <= options.tolerance)) differs = true;  // a NaN differs
        largest = std::max(largest, std::isnan(d) ? INFINITY : d);
        squares += d * d;
      }
      differing += differs ? 1 : 0;
    }
  }
  const double share = static_cast<double>(differing) / static_cast<double>(pixels);
  fmt::print("{} of {} pixels differ by more than {:g} ({:.4f} %); largest difference {:g}; RMSE {:g}\n",
             differing, pixels, options.tolerance, 100 * share, largest,
             std::sqrt(squares / (3 * static_cast<double>(pixels))));
  return share <= options.share ? kComplete : kRenderFailure;
}

}  // namespace

void add_compare_command(CommandLine& line) {
  const auto o = std::make_shared<CompareOptions>();
  Verb verb;
  verb.name = "compare";
  verb.help = "compare two images; exit code 1 if they differ";
  verb.examples = {{"rayfarm compare before.exr after.exr --tolerance 0.001 --share 0.01",
                    "no more than a hundredth of the pixels may differ by more than a thousandth"}};
  verb.run = [o](const Renders&) { return compare(*o); };
  Options options = line.add(std::move(verb));
  options.text("A", o->a, "an image of any format").required();
  options.text("B", o->b, "another of the same size").required();
  options.number("--tolerance", o->tolerance, 0, 1e6,
                 "largest difference of a channel that counts as equal (default: 0)");
  options.number("--share", o->share, 0, 1, "share of pixels that may differ by more (default: 0)");
}

}  // namespace rayfarm
