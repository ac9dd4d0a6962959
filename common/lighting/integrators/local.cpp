// The models of Phong (Equation 2.4) and of Torrance and Sparrow (thesis 2.2.3): light that comes from the
// sources straight away, and no other.
#include "common/lighting/environment.h"
#include "common/lighting/integrators/classical_surface.h"
#include "common/lighting/integrators/integrator.h"

namespace rayfarm {
namespace {

class LocalIntegrator : public Integrator {
 public:
  explicit LocalIntegrator(Highlights::Shape shape) : highlights_{shape} {}

 private:
  size_t follow(const FrameContext& context, const RayPacket& rays, std::span<const SampleId> ids,
                RayCounts& counts, Color* colors) override {
    OfPacket<Hit> hits;
    hits.resize_for_overwrite(rays.size);
    closest_hits(context.scene, context.pose, rays, hits.data());
    OfPacket<ClassicalSurface> surfaces;
    OfPacket<size_t> ray_of_surface;
    for (size_t i = 0; i < rays.size; ++i) {
      if (!hits[i].is_hit()) {
        colors[i] = eval_background(context.scene, rays.direction(i));
        continue;
      }
      surfaces.emplace_back(context, rays[i], hits[i], hits[i].t * context.spread, ids[i], 0)
          .add_ambient_and_emission(context);
      ray_of_surface.push_back(i);
    }
    if (!surfaces.empty()) add_direct_light(context, highlights_, surfaces.span(), counts);
    for (size_t k = 0; k < surfaces.size(); ++k) colors[ray_of_surface[k]] = surfaces[k].light();
    return surfaces.size();
  }

  Highlights highlights_;
};

}  // namespace

std::unique_ptr<Integrator> make_phong() {
  return std::make_unique<LocalIntegrator>(Highlights::Shape::phong);
}

std::unique_ptr<Integrator> make_torrance_sparrow() {
  return std::make_unique<LocalIntegrator>(Highlights::Shape::torrance_sparrow);
}

}  // namespace rayfarm
