// The pictures against a second, deliberately simple tracer: it shares no code with the renderer but the
// loaders' description and the vector type, tests every primitive in turn with textbook formulas in double,
// and recurses by Equation 2.12 within the limits of section 2.3.4. Frames must agree to 1e-3 on 99.7 % of
// the pixels.
#include <cstring>
#include <deque>
#include <filesystem>
#include <functional>

#include "common/lighting/renderer.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

struct NaiveHit {
  double t = 1e300;
  Vec3 normal{0};  // unit; on the side from where the surface is seen as its outside
  const MaterialDescription* material = nullptr;
};

class NaiveTracer {
 public:
  NaiveTracer(const SceneDescription& scene, int depth) : scene_(scene), depth_(depth) {
    flatten(scene.root, Affine{});
  }

  Color trace(const Vec3& origin, const Vec3& direction, int reflections = 0, int transmissions = 0) const {
    const NaiveHit hit = closest(origin, direction, 1e300);
    if (!hit.material) return scene_.background;
    const MaterialDescription& m = *hit.material;
    const Vec3 p = origin + hit.t * direction;
    const bool from_outside = glm::dot(direction, hit.normal) < 0;
    const Vec3 n = from_outside ? hit.normal : -hit.normal;
    Color diffuse = m.ambient * scene_.ambient, highlight(0);
    for (const Light& light : scene_.lights) {
      const Vec3 l = normalized(light.position - p);
      if (glm::dot(n, l) <= 0) continue;
      if (closest(p, l, glm::length(light.position - p)).material) continue;
      diffuse += m.diffuse * glm::dot(n, l) * light.color;
      const Vec3 r = 2 * glm::dot(n, l) * n - l;  // the light's mirror direction, towards the viewer
      if (m.specular > 0)
        highlight += m.specular * std::pow(std::max(0.0, -glm::dot(r, direction)), m.shininess) * light.color;
    }
    Color color = m.color * diffuse + highlight;
    if (1 + reflections + transmissions == depth_) return color;
    double reflect = m.reflect;
    if (m.transmit > 0) {
      const double ratio = from_outside ? 1 / m.index : m.index, c = -glm::dot(direction, n);
      const double sine2 = ratio * ratio * (1 - c * c);
      if (sine2 > 1)
        reflect += m.transmit;
      else if (transmissions < 7)
        color += m.transmit * trace(p, normalized(ratio * direction + (ratio * c - std::sqrt(1 - sine2)) * n),
                                    reflections, transmissions + 1);
    }
    if (reflect > 0 && reflections < 4)
      color += reflect * trace(p, normalized(direction - 2 * glm::dot(direction, n) * n), reflections + 1,
                               transmissions);
    return color;
  }

 private:
  struct Placed {
    const PrimitiveDescription* primitive;
    Affine world;  // rigid in these scenes
    Vec3 middle{0};
    double reach = 0;  // polygons: no point is farther from the middle
  };

  void place(const PrimitiveDescription& p, const Affine& world) {
    placed_.push_back({&p, world});
    if (const auto* polygon = std::get_if<PolygonShape>(&p.shape)) {
      for (const Vec3& q : polygon->points)
        placed_.back().middle += world.point(q) / double(polygon->points.size());
      for (const Vec3& q : polygon->points)
        placed_.back().reach =
            std::max(placed_.back().reach, 1.001 * glm::length(world.point(q) - placed_.back().middle));
    }
  }

  void flatten(uint32_t object, const Affine& world) {
    for (const PrimitiveDescription& p : scene_.objects[object].primitives) {
      const auto* mesh = std::get_if<MeshShape>(&p.shape);
      if (!mesh) place(p, world);
      for (size_t i = 0; mesh && i < mesh->triangles.size(); ++i) {
        PolygonShape triangle;
        for (int k = 0; k < 3; ++k) triangle.points.emplace_back(mesh->positions[mesh->triangles[i][k]]);
        place(of_meshes_.emplace_back(PrimitiveDescription{triangle, p.material, p.place}), world);
      }
    }
    for (const ChildDescription& child : scene_.objects[object].children) {
      Affine local = world;
      for (auto step = child.transform.rbegin(); step != child.transform.rend(); ++step)
        local = local * eval_transform(step->kind, step->curve.values[0], step->axis, step->matrix);
      flatten(child.object, local);
    }
  }

  NaiveHit closest(const Vec3& o, const Vec3& d, double limit) const {
    NaiveHit best;
    best.t = limit;
    for (const Placed& placed : placed_) {
      const double least = 1e-9 * (1 + max_magnitude(o));
      const auto offer = [&](double t, const Vec3& normal) {
        if (t > least && t < best.t) best = {t, normal, &scene_.materials[placed.primitive->material]};
      };
      if (const auto* s = std::get_if<SphereShape>(&placed.primitive->shape))
        sphere(placed.world.point(s->center), s->radius, o, d, offer);
      if (const auto* c = std::get_if<ConeShape>(&placed.primitive->shape)) cone(*c, o, d, offer);
      if (const auto* g = std::get_if<PolygonShape>(&placed.primitive->shape))
        polygon(*g, placed, o, d, best.t, offer);
    }
    return best;
  }

  using Offer = std::function<void(double, const Vec3&)>;

  static void sphere(const Vec3& center, double radius, const Vec3& o, const Vec3& d, const Offer& offer) {
    const Vec3 oc = o - center;
    const double b = glm::dot(oc, d), c = glm::dot(oc, oc) - radius * radius, q = b * b - c;
    if (q < 0) return;
    for (const double t : {-b - std::sqrt(q), -b + std::sqrt(q)}) offer(t, normalized(oc + t * d));
  }

  static void cone(const ConeShape& shape, const Vec3& o, const Vec3& d, const Offer& offer) {
    // In a frame along the axis: distance from the axis equals the radius there.
    const double length = glm::length(shape.apex - shape.base);
    const Vec3 axis = (shape.apex - shape.base) / length;
    const double slope = (shape.apex_radius - shape.base_radius) / length;
    const Vec3 oc = o - shape.base;
    const double oh = glm::dot(oc, axis), dh = glm::dot(d, axis);
    const Vec3 op = oc - oh * axis, dp = d - dh * axis;
    const double r = shape.base_radius + slope * oh;
    const double a = glm::dot(dp, dp) - slope * slope * dh * dh, b = glm::dot(op, dp) - slope * dh * r,
                 c = glm::dot(op, op) - r * r;
    const double q = b * b - a * c;
    if (q < 0 || a == 0) return;
    for (const double t : {(-b - std::sqrt(q)) / a, (-b + std::sqrt(q)) / a}) {
      const double h = oh + t * dh;
      if (h >= 0 && h <= length) offer(t, normalized(normalized(op + t * dp) - slope * axis));
    }
  }

  static void polygon(const PolygonShape& shape, const Placed& placed, const Vec3& o, const Vec3& d,
                      double limit, const Offer& offer) {
    // Lines that pass far from the polygon can't meet it.
    const Vec3 to_middle = placed.middle - o;
    if (glm::length(to_middle - glm::dot(to_middle, d) * d) > placed.reach) return;
    std::vector<Vec3> v;
    for (const Vec3& p : shape.points) v.push_back(placed.world.point(p));
    Vec3 n(0);
    for (size_t i = 1; i + 1 < v.size(); ++i) n += glm::cross(v[i] - v[0], v[i + 1] - v[0]);
    n = normalized(n);
    const double t = glm::dot(n, v[0] - o) / glm::dot(n, d);
    if (!(t > 0 && t < limit)) return;
    const Vec3 p = o + t * d;
    double angle = 0;  // the sum of the angles under which the edges are seen: a full turn inside
    for (size_t i = 0; i < v.size(); ++i) {
      const Vec3 a = v[i] - p, b = v[(i + 1) % v.size()] - p;
      angle += std::atan2(glm::dot(n, glm::cross(a, b)), glm::dot(a, b));
    }
    if (std::abs(angle) < M_PI) return;
    if (shape.normals.empty()) {
      offer(t, n);
    } else {  // three corners: weights by areas
      const double whole = glm::dot(n, glm::cross(v[1] - v[0], v[2] - v[0]));
      const double w1 = glm::dot(n, glm::cross(p - v[0], v[2] - v[0])) / whole,
                   w2 = glm::dot(n, glm::cross(v[1] - v[0], p - v[0])) / whole;
      const Vec3 smooth =
          normalized((1 - w1 - w2) * shape.normals[0] + w1 * shape.normals[1] + w2 * shape.normals[2]);
      offer(t, glm::dot(smooth, n) < 0 ? -smooth : smooth);
    }
  }

  const SceneDescription& scene_;
  int depth_;
  std::deque<PrimitiveDescription> of_meshes_;  ///< their triangles
  std::vector<Placed> placed_;
};

void compare(const std::string& path, int width, int height, uint32_t depth) {
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const SceneDescription description = load_scene(path);
  const CompiledScene compiled = compile(description);
  RenderSettings settings;
  settings.width_px = width;
  settings.height_px = height;
  settings.crop = {0, 0, width, height};
  settings.max_depth = depth;
  settings.pixel_format = PixelFormat::float32;
  const RenderedPixels ours = Renderer(compiled.scene, settings).render(0, settings.crop, [] {});

  const ViewDescription& view = description.view;
  const Vec3 eye(view.location.values[0]), forward = normalized(Vec3(view.look_at->values[0]) - eye);
  const Vec3 right = normalized(glm::cross(forward, Vec3(view.up.values[0]))),
             up = glm::cross(right, forward);
  const double half = std::tan(view.field_of_view.values[0].x * M_PI / 360);
  const NaiveTracer naive(description, static_cast<int>(depth));
  int differing = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double u = (2 * (x + 0.5) / width - 1) * half,
                   v = (1 - 2 * (y + 0.5) / height) * half * height / width;
      const Color expected = naive.trace(eye, normalized(forward + u * right + v * up));
      float pixel[3];
      std::memcpy(pixel, ours.pixels.data() + 12 * (y * width + x), sizeof pixel);
      const Color found(pixel[0], pixel[1], pixel[2]);
      differing += max_magnitude(found - expected) > 1e-3 ? 1 : 0;
    }
  EXPECT_LE(differing, 0.003 * width * height) << path;
}

TEST(NaiveTracer, DiffuseRoom) {
  compare(std::string(RAYFARM_SOURCE) + "/scenes/diffuse_room.yaml", 200, 150, 12);
}

class NaiveSpd : public testing::TestWithParam<const char*> {};
TEST_P(NaiveSpd, Agrees) {
  compare(std::string(RAYFARM_SOURCE) + "/../shared/assets/spd/" + GetParam() + ".nff", 48, 48, 5);
}
INSTANTIATE_TEST_SUITE_P(, NaiveSpd, testing::Values("balls", "gears", "mount", "rings", "teapot", "tetra"));

}  // namespace
}  // namespace rayfarm
