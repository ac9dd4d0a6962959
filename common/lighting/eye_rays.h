#pragma once
// Eye rays, eight at a time.
#include "common/math/ray_packet.h"
#include "common/scene/camera.h"

namespace rayfarm {

/// Sets all lanes of `rays` to the rays that camera.ray(x[i], y[i]) gives, to the last bit; its size stays as
/// it is. `x`, `y`: raster positions of eight rays, aligned to 64 bytes.
void make_eye_rays(const Camera& camera, const double* x, const double* y, RayPacket& rays);

}  // namespace rayfarm
