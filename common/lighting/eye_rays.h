#pragma once
// Eye rays, eight at a time.
#include <array>

#include "common/math/ray_packet.h"
#include "common/scene/camera.h"

namespace rayfarm {

/// Where the rays of a packet pass through the picture: raster positions.
struct RasterPoints {
  RasterPoints() {}  // leaves the lanes as they are
  alignas(64) std::array<double, kMostPacketRays> x, y;
};

/// Sets all lanes of `rays` to the rays that camera.ray(at.x[i], at.y[i]) gives, to the last bit; its size
/// stays as it is.
void make_eye_rays(const Camera& camera, const RasterPoints& at, RayPacket& rays);

}  // namespace rayfarm
