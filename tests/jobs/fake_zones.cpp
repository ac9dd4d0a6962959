// rayfarm with zones that hold no light (tests/fake_zones.h) in place of its own: --lighting phong has them,
// and its pictures show what nodes were given of them.
#include "tests/fake_zones.h"

#include <chrono>
#include <cstdlib>
#include <thread>

#include "host/render/zone_solvers.h"
#include "node/node.h"

namespace rayfarm {
namespace {

/// A number of the environment, which mpirun gives to all ranks.
uint64_t number(const char* name, uint64_t otherwise) {
  const char* const text = std::getenv(name);
  return text ? std::strtoull(text, nullptr, 10) : otherwise;
}

test::FakeZones zones() {
  test::FakeZones zones;
  zones.slots = number("FAKE_SLOTS", zones.slots);
  zones.units = number("FAKE_UNITS", zones.units);
  zones.units_per_item = number("FAKE_BATCH", zones.units_per_item);
  const auto nap = std::chrono::microseconds(number("FAKE_UNIT_US", 0));
  const bool fails = std::getenv("FAKE_FAILS");
  zones.before_unit = [nap, fails](uint64_t unit) {
    if (fails && unit == 3) throw std::runtime_error("the tracer's own error");
    if (nap.count() > 0) std::this_thread::sleep_for(nap);
  };
  return zones;
}

/// Of the frame's own pose.
test::FakeZones zones_of(int frame) {
  test::FakeZones of_frame = zones();
  of_frame.units += static_cast<uint64_t>(frame);
  return of_frame;
}

/// Turns bits of the pixels by the light that it was given.
class ShowingPictures : public PictureWorker {
 public:
  explicit ShowingPictures(std::unique_ptr<PictureWorker> pictures) : pictures_(std::move(pictures)) {}
  void set_zones(std::span<const std::byte> solution) override { digest_ = test::digest(solution); }
  ItemResult work(FrameNumber frame, const DisplayPolygon& polygon, const RenderPass& pass,
                  const std::function<void()>& pulse) override {
    ItemResult result = pictures_->work(frame, polygon, pass, pulse);
    for (std::byte& b : result.bytes) b ^= static_cast<std::byte>(digest_);
    return result;
  }

 private:
  std::unique_ptr<PictureWorker> pictures_;
  uint64_t digest_ = 0;
};

}  // namespace

MakeZoneSolver zone_solvers_of(const RenderSettings& settings) {
  if (settings.lighting != LightingModel::phong) return {};
  return [](const Scene&, const RenderSettings&, int frame) {
    return std::make_unique<test::FakeSolver>(zones_of(frame));
  };
}

Workers make_workers() {
  return {[](const JobPlan& plan, std::span<const std::byte> scene) {
            return std::make_unique<ShowingPictures>(make_scene_worker(plan, scene));
          },
          [](const JobPlan&, std::span<const std::byte>, FrameNumber frame) {
            return std::make_unique<test::FakeTracer>(zones_of(frame.value()));
          }};
}

}  // namespace rayfarm
