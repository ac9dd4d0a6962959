#pragma once
// Zones that hold no light: a solver and a tracer that add up pseudo-random numbers, as cheap as may be, to
// see what a farm makes of stages. What an item gives depends on its units and on all data of its stage, and
// how much work a stage is on the sums before it.
#include <cstring>

#include "common/lighting/zones/zone_solver.h"

namespace rayfarm::test {

struct FakeZones {
  uint64_t slots = 100;  ///< numbers that are added up, of 8 bytes
  uint64_t units = 500;  ///< of the first stage; later ones have half to one and a half times as many
  uint64_t units_per_item = 7;
  int stages = 4;
  std::function<void(uint64_t unit)> before_unit = [](uint64_t) {};  ///< may throw, or take its time
};

inline uint64_t mix(uint64_t x) {
  x ^= x >> 31;
  x *= 0x9e3779b97f4a7c15;
  x ^= x >> 29;
  x *= 0xbf58476d1ce4e5b9;
  return x ^ x >> 32;
}
inline uint64_t digest(std::span<const std::byte> bytes) {
  uint64_t sum = bytes.size();
  for (const std::byte b : bytes) sum = sum * 0x100000001b3 + static_cast<uint64_t>(b);
  return mix(sum);
}

class FakeSolver : public ZoneSolver {
 public:
  explicit FakeSolver(const FakeZones& zones) : zones_(zones), sums_(zones.slots) {}

  std::optional<ZoneStage> next_stage() override {
    if (stage_ == zones_.stages) return std::nullopt;
    ZoneStage stage;
    stage.name = "round " + std::to_string(++stage_);
    stage.data = solution();
    stage.units =
        stage_ == 1 ? zones_.units : zones_.units / 2 + mix(static_cast<uint64_t>(sums_[0])) % zones_.units;
    stage.units_per_item = zones_.units_per_item;
    has_come_.assign(stage.items(), false);
    return stage;
  }
  void add(uint64_t item, std::span<const std::byte> result) override {
    if (result.size() != 8 * sums_.size()) throw std::runtime_error("of another size");
    if (has_come_.at(item)) throw std::logic_error("an item came twice");
    has_come_[item] = true;
    for (size_t i = 0; i < sums_.size(); ++i) {
      int64_t value;
      std::memcpy(&value, result.data() + 8 * i, 8);
      sums_[i] += value;
    }
    ++added_;
  }
  ZoneProgress progress() const override { return {stage_, 1.0 / (1 + stage_), 3 * added_}; }
  std::vector<std::byte> solution() const override {
    const auto bytes = std::as_bytes(std::span(sums_));
    return {bytes.begin(), bytes.end()};
  }

 private:
  FakeZones zones_;
  std::vector<int64_t> sums_;
  std::vector<bool> has_come_;
  int stage_ = 0;
  uint64_t added_ = 0;
};

class FakeTracer : public ZoneTracer {
 public:
  explicit FakeTracer(const FakeZones& zones) : zones_(zones) {}

  void begin(std::span<const std::byte> data) override {
    if (data.size() != 8 * zones_.slots) throw std::runtime_error("a stage's data are damaged");
    digest_ = digest(data);
  }
  ZoneItemResult work(uint64_t first, uint64_t count, const std::function<void()>& pulse) override {
    std::vector<uint64_t> sums(zones_.slots);
    for (uint64_t unit = first; unit < first + count; ++unit) {
      zones_.before_unit(unit);
      pulse();
      for (uint64_t i = 0; i < 8; ++i) {
        const uint64_t random = mix(digest_ + unit * 64 + i);
        sums[random % sums.size()] += random >> 20;
      }
    }
    ZoneItemResult result;
    const auto bytes = std::as_bytes(std::span(sums));
    result.bytes.assign(bytes.begin(), bytes.end());
    result.rays[RayKind::diffuse] = count;
    return result;
  }

 private:
  FakeZones zones_;
  uint64_t digest_ = 0;
};

/// What comes of them without a farm.
inline std::vector<std::byte> solve_alone(const FakeZones& zones) {
  FakeSolver solver(zones);
  FakeTracer tracer(zones);
  while (const auto stage = solver.next_stage()) {
    tracer.begin(stage->data);
    for (uint64_t item = 0; item < stage->items(); ++item) {
      const uint64_t first = item * stage->units_per_item;
      solver.add(item,
                 tracer.work(first, std::min(stage->units_per_item, stage->units - first), [] {}).bytes);
    }
  }
  return solver.solution();
}

}  // namespace rayfarm::test
