#include "protocol/block_symbols.h"

namespace rayfarm::block_model {
namespace {

constexpr ContextTables kContextOf = make_context_tables(1);
constexpr std::array<uint8_t, 256> kTokenOf = [] {
  std::array<uint8_t, 256> table{};
  for (size_t folded = 0; folded < table.size(); ++folded)
    table[folded] = token_of(static_cast<int>(folded)).token;
  return table;
}();

/// By pixel: values of the three channels, and what is expected of them.
struct Planes {
  std::vector<int16_t> value[3], prediction[3], unrest[3];

  void resize(size_t pixels) {
    for (auto* planes : {value, prediction, unrest})
      for (size_t c = 0; c < 3; ++c) planes[c].resize(pixels);
  }
};

void split_channels(std::span<const std::byte> pixels, Planes& planes) {
  for (size_t i = 0; i < pixels.size() / 3; ++i) {
    const int red = std::to_integer<int>(pixels[3 * i]), green = std::to_integer<int>(pixels[3 * i + 1]),
              blue = std::to_integer<int>(pixels[3 * i + 2]);
    planes.value[0][i] = static_cast<int16_t>(green);
    planes.value[1][i] = static_cast<int16_t>(red - green);
    planes.value[2][i] = static_cast<int16_t>(blue - green);
  }
}

void expect_all(const std::vector<int16_t>& value, size_t width, std::vector<int16_t>& prediction,
                std::vector<int16_t>& unrest) {
  const auto keep = [&](size_t i, const Expected& expected) {
    prediction[i] = static_cast<int16_t>(expected.prediction);
    unrest[i] = static_cast<int16_t>(expected.unrest);
  };
  for (size_t x = 1; x < width; ++x) keep(x, expect_in_top_row(value[x - 1], value[x > 1 ? x - 2 : 0]));
  for (size_t begin = width; begin < value.size(); begin += width) {
    const int16_t *row = value.data() + begin, *above = row - width;
    const size_t last = width - 1;
    const int16_t before = begin > width ? *(above - width) : above[0];
    keep(begin, expect(above[0], above[0], before, above[std::min<size_t>(1, last)]));
    for (size_t x = 1; x < last; ++x)
      keep(begin + x, expect(row[x - 1], above[x], above[x - 1], above[x + 1]));
    if (last > 0) keep(begin + last, expect(row[last - 1], above[last], above[last - 1], above[last]));
  }
}

/// The slope that leaves least of `of` by `by`, both differences of values and predictions.
template <size_t N>
size_t best_slope(const std::array<int, N>& slopes, const Planes& planes, size_t by, size_t of,
                  size_t begin) {
  std::array<int64_t, N> left{};
  const size_t n = planes.value[0].size();
  for (size_t s = 0; s < N; ++s) {
    const int slope = slopes[s];
    int64_t sum = 0;
    constexpr size_t kRun = 4096;  // 4,096 differences of at most 1,530 fit 32 bits, which are added faster
    for (size_t i = begin; i < n;) {
      int32_t part = 0;
      for (const size_t end = std::min(n, i + kRun); i < end; ++i)
        part += std::abs(planes.value[of][i] - planes.prediction[of][i] -
                         share(slope, planes.value[by][i] - planes.prediction[by][i]));
      sum += part;
    }
    left[s] = sum;
  }
  return static_cast<size_t>(std::min_element(left.begin(), left.end()) - left.begin());
}

}  // namespace

void make_symbols(std::span<const std::byte> pixels, int width, int height, Symbols& out) {
  const auto w = static_cast<size_t>(width), n = w * static_cast<size_t>(height);
  thread_local Planes planes;
  planes.resize(n);
  split_channels(pixels, planes);
  for (size_t c = 0; c < 3; ++c) expect_all(planes.value[c], w, planes.prediction[c], planes.unrest[c]);
  out.red_slope = best_slope(kRedSlopes, planes, 0, 1, w);
  out.blue_slope = best_slope(kBlueSlopes, planes, 1, 2, w);
  out.symbols.resize(3 * n - 1);

  Symbol* symbol = out.symbols.data();
  for (size_t c = 1; c < 3; ++c) *symbol++ = {static_cast<uint8_t>(kFirstColour), fold(planes.value[c][0])};
  const auto put = [&](size_t i, int red_slope, int blue_slope, const auto& green_contexts,
                       const auto& colour_contexts) {
    const int green = planes.value[0][i], green_off = green - planes.prediction[0][i];
    int other_off = green_off, slope = red_slope;
    uint8_t folded = fold(green_off);
    *symbol++ = {static_cast<uint8_t>(green_contexts[static_cast<size_t>(planes.unrest[0][i])]), folded};
    for (size_t c = 1; c < 3; ++c) {
      const int value = planes.value[c][i], prediction = planes.prediction[c][i];
      const int off = green + value - clamped(prediction + green + share(slope, other_off));
      const uint32_t context =
          colour_contexts[static_cast<size_t>(planes.unrest[c][i])] + size_of_token(kTokenOf[folded]);
      folded = fold(other_off < 0 ? -off : off);
      *symbol++ = {static_cast<uint8_t>(context), folded};
      other_off = value - prediction;
      slope = blue_slope;
    }
  };
  for (size_t i = 1; i < w; ++i) put(i, 0, 0, kContextOf.green_top, kContextOf.colour_top);
  for (size_t i = w; i < n; ++i)
    put(i, kRedSlopes[out.red_slope], kBlueSlopes[out.blue_slope], kContextOf.green, kContextOf.colour);
}

}  // namespace rayfarm::block_model
