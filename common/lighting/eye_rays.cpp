#include "common/lighting/eye_rays.h"

#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "common/lighting/eye_rays.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "common/math/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace rayfarm {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

void set_eye_rays(const Camera& camera, const RasterPoints& at, RayPacket& rays) {
  const RealTag d;
  for (size_t lane = 0; lane < kMostPacketRays; lane += kLanes) {
    const Real3 direction = all(camera.top_left) + hn::Load(d, &at.x[lane]) * all(camera.per_x) +
                            hn::Load(d, &at.y[lane]) * all(camera.per_y);
    store3(all(camera.location), rays.origins, lane);
    store3(normalized(direction), rays.directions, lane);
    hn::Store(real(std::numeric_limits<double>::infinity()), d, rays.t_max + lane);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace rayfarm
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rayfarm {

HWY_EXPORT(set_eye_rays);

void make_eye_rays(const Camera& camera, const RasterPoints& at, RayPacket& rays) {
  HWY_DYNAMIC_DISPATCH(set_eye_rays)(camera, at, rays);
}

}  // namespace rayfarm
#endif
