// Gouraud's shading (thesis 2.3.5): "the intensity at the nodes of the polygon using the average normals and
// the desired lighting model", and between them "a linear interpolation of the intensities at the nodes".
#include "tests/unit/probe.h"

namespace rayfarm {
namespace {

/// A square of side 2 in the plane z = 0 with other normals at each corner, and what follows.
std::string square(const std::string& rest, const char* smooth = "gouraud") {
  return fmt::format(R"(
ambient: 0.5
materials: {{m: {{color: [1, 0.5, 0.25], ambient: 0.2, diffuse: 0.6, specular: 0.3, shininess: 4}}}}
lights: [{{position: [3, 3, 3], color: [0.9, 0.8, 0.7]}}]
scene:
  - {{material: m, polygon: {{points: [[-1,-1,0],[1,-1,0],[1,1,0],[-1,1,0]], smooth: {},
     normals: [[-1,-1,2],[1,-1,3],[1,1,1],[-1,1,4]]}}}}
)",
                     smooth) +
         rest;
}

constexpr std::array kCorners{Vec3(-1, -1, 0), Vec3(1, -1, 0), Vec3(1, 1, 0), Vec3(-1, 1, 0)};
const std::array kNormals{normalized(Vec3(-1, -1, 2)), normalized(Vec3(1, -1, 3)), normalized(Vec3(1, 1, 1)),
                          normalized(Vec3(-1, 1, 4))};

/// Equation 2.4 at a corner, for a viewer at `eye`.
Color light_at(size_t corner, const Vec3& eye, bool is_lit = true) {
  const Color surface(1, 0.5, 0.25), lamp(0.9, 0.8, 0.7);
  Color sum = surface * 0.2 * 0.5;
  const Vec3 n = kNormals[corner], to_light = normalized(Vec3(3, 3, 3) - kCorners[corner]),
             view = normalized(kCorners[corner] - eye);
  const double cosine = glm::dot(n, to_light);
  if (!is_lit || cosine <= 0) return sum;
  const double mirrored = std::max(0.0, glm::dot(view - 2 * glm::dot(view, n) * n, to_light));
  return sum + surface * 0.6 * cosine * lamp + 0.3 * std::pow(mirrored, 4) * lamp;
}

Probe make_probe(const std::string& text, LightingModel model = LightingModel::phong) {
  Probe probe(text);
  probe.settings.lighting = model;
  probe.settings.max_depth = 5;
  return probe;
}

TEST(Gouraud, TheIntensitiesOfTheNodesAreInterpolated) {
  Probe probe = make_probe(square(""));
  const Vec3 eye(0.2, -0.3, 4);
  const auto seen = [&](const Vec3& p) { return probe.mean(eye, p - eye, 1); };
  Color mean(0);
  for (size_t i = 0; i < 4; ++i) mean += 0.25 * light_at(i, eye);
  expect_color(seen(Vec3(0)), mean, 1e-9);  // the middle of a square has the mean of its corners
  for (size_t i = 0; i < 4; ++i) {
    expect_color(seen(kCorners[i] * (1 - 1e-7)), light_at(i, eye), 1e-6);
    const Vec3 on_edge = 0.3 * kCorners[i] + 0.7 * kCorners[(i + 1) % 4];  // linear along edges
    expect_color(seen(on_edge * (1 - 1e-9)), 0.3 * light_at(i, eye) + 0.7 * light_at((i + 1) % 4, eye), 1e-6);
  }
  EXPECT_EQ(probe.counts[RayKind::shadow], 9 * 3u)
      << "from each corner that faces the light: the first doesn't";
}

TEST(Gouraud, ShadowsFallOnNodesAlone) {
  const Vec3 eye(0, 0, 4);
  // A ball between the light and the middle shows nothing; one beside a corner darkens that corner.
  Probe middle = make_probe(square("  - {sphere: {center: [0.3, 0.3, 0.3], radius: 0.15}}\n"));
  Color mean(0);
  for (size_t i = 0; i < 4; ++i) mean += 0.25 * light_at(i, eye);
  expect_color(middle.mean(eye, -eye, 1), mean, 1e-9);
  Probe corner = make_probe(square("  - {sphere: {center: [1.4, 1.4, 0.6], radius: 0.3}}\n"));
  Color less(0);
  for (size_t i = 0; i < 4; ++i) less += 0.25 * light_at(i, eye, i != 2);
  expect_color(corner.mean(eye, -eye, 1), less, 1e-9);
}

TEST(Gouraud, NeighboursMeetWithoutAStep) {
  // A box of smooth faces under transform: along edges both polygons show what their common nodes do.
  const std::string text = R"(
lights: [{position: [4, 5, 6]}, {position: [-2, 6, 3], color: 0.4}]
materials: {m: {color: 0.9, ambient: 0.1, diffuse: 0.7, specular: 0.4, shininess: 9}}
scene:
  - {material: m, transform: [{scale: [1, 1.3, 0.8]}, {rotate: {axis: [1, 2, 0], degrees: 35}}], polygons: {smooth: gouraud,
     points: [[-1,-1,-1],[1,-1,-1],[1,1,-1],[-1,1,-1],[-1,-1,1],[1,-1,1],[1,1,1],[-1,1,1]],
     faces: [[3,2,1,0],[4,5,6,7],[0,1,5,4],[2,3,7,6],[1,2,6,5],[3,0,4,7]]}}
)";
  for (const LightingModel model :
       {LightingModel::phong, LightingModel::torrance_sparrow, LightingModel::whitted}) {
    Probe probe = make_probe(text, model);
    const Scene& s = probe.compiled.scene;
    const Vec3 eye(1, 2, 7);
    int edges = 0;
    const auto to_world = [&](const Vec3& p) { return probe.pose[0].world_from_object.point(p); };
    for (const auto& [a, b] : {std::pair(6u, 7u), std::pair(6u, 5u), std::pair(6u, 2u)})
      for (const double along : {0.2, 0.5, 0.9}) {
        const auto point = [&](uint32_t i) {
          return Vec3(i & 1 ? (i == 1 || i == 5 ? 1 : -1) : (i == 2 || i == 6 ? 1 : -1), (i & 2) ? 1 : -1,
                      i & 4 ? 1 : -1);
        };
        const Vec3 on_edge = (1 - along) * point(a) + along * point(b);
        // Two points beside the edge, one on each face.
        std::vector<Color> seen;
        for (int axis = 0; axis < 3; ++axis) {
          if (point(a)[axis] != point(b)[axis]) continue;
          Vec3 beside = on_edge;
          beside[axis] -= 1e-7 * on_edge[axis];
          const Vec3 p = to_world(beside);
          if (!any_hit(s, probe.pose, {eye, p - eye, 1 - 1e-6})) seen.push_back(probe.mean(eye, p - eye, 1));
        }
        if (seen.size() < 2) continue;
        ++edges;
        expect_color(seen[0], seen[1], 1e-5);
      }
    EXPECT_GE(edges, 3);
  }
}

TEST(Gouraud, MirroredRaysLeaveFromTheHitAlongTheInterpolatedNormal) {
  const std::string room =
      "background: [0.2, 0.4, 0.8]\nlights: []\nmaterials: {m: {ambient: 0, diffuse: 0, reflect: 0.9},"
      " lit: {ambient: 1, diffuse: 0}}\nscene:\n"
      "  - {material: lit, sphere: {center: [2, 1, 4], radius: 1.5}}\n"
      "  - {material: m, polygon: {points: [[-1,-1,0],[1,-1,0],[1,1,0],[-1,1,0]], "
      "normals: [[-1,-1,2],[1,-1,3],[1,1,1],[-1,1,4]], smooth: ";
  Probe gouraud = make_probe(room + "gouraud}}\n", LightingModel::whitted),
        phong = make_probe(room + "phong}}\n", LightingModel::whitted);
  bool differs = false;
  for (int i = 0; i < 40; ++i) {
    const Vec3 eye(0.1, 0.2, 6), p(-0.9 + 0.045 * i, 0.5 * std::sin(i), 0);
    const Color a = gouraud.mean(eye, p - eye, 1);
    EXPECT_EQ(a, phong.mean(eye, p - eye, 1));
    differs = differs || a != gouraud.mean(eye, -eye, 1);
  }
  EXPECT_TRUE(differs);
}

TEST(Gouraud, PathTakesNormalsInItsPlace) {
  Probe gouraud(square("")), phong(square("", "phong"));
  const Vec3 eye(0.2, -0.3, 4);
  EXPECT_EQ(gouraud.mean(eye, Vec3(0.3, 0.1, 0) - eye, 8), phong.mean(eye, Vec3(0.3, 0.1, 0) - eye, 8));
}

TEST(Gouraud, ATextureColoursWhatIsInterpolated) {
  // The same light with a pattern of two colours: their ratio is that of the colours.
  const std::string textured =
      "textures: {t: {kind: checker, first: 1, second: 0.5, scale: 0.5}}\nlights: [{position: [3, 3, 3]}]\n"
      "materials: {m: {ambient: 0.1, diffuse: 0.8%}}\nscene: [{material: m, polygon: {smooth: gouraud, "
      "points: "
      "[[-1,-1,0],[1,-1,0],[1,1,0],[-1,1,0]], normals: [[-1,-1,2],[1,-1,3],[1,1,1],[-1,1,4]]}}]\n";
  const auto with = [&](const std::string& text) {
    std::string all = textured;
    all.replace(all.find('%'), 1, text);
    return all;
  };
  Probe plain = make_probe(with("")), patterned = make_probe(with(", texture: t"));
  const Vec3 eye(0, 0, 4);
  bool is_first = false, is_second = false;
  for (const Vec3 p : {Vec3(0.25, 0.25, 0), Vec3(-0.25, 0.25, 0), Vec3(0.75, 0.25, 0)}) {
    const double ratio = patterned.mean(eye, p - eye, 1).x / plain.mean(eye, p - eye, 1).x;
    is_first = is_first || std::abs(ratio - 1) < 1e-9;
    is_second = is_second || std::abs(ratio - 0.5) < 1e-9;
  }
  EXPECT_TRUE(is_first && is_second);
}

TEST(Gouraud, BumpsThatCanNotShowAreNoted) {
  const std::string text =
      "textures: {t: {kind: noise}}\nmaterials: {m: {bump: {texture: t, height: 0.1}}}\nscene:\n"
      "  - {material: m, polygon: {points: [[-1,-1,0],[1,-1,0],[1,1,0],[-1,1,0]], "
      "normals: [[-1,-1,2],[1,-1,3],[1,1,1],[-1,1,4]], smooth: ";
  const auto notes = [&](const char* smooth) {
    std::string all;
    const CompiledScene compiled = compile(test::load_yaml(test::view_text() + text + smooth + "}}\n"));
    for (const std::string& line : compiled.notes.lines()) all += line + "\n";
    return all;
  };
  EXPECT_NE(notes("gouraud").find("scene.yaml:5:"), std::string::npos) << notes("gouraud");
  EXPECT_NE(notes("gouraud").find("no bump map tilts"), std::string::npos);
  EXPECT_EQ(notes("phong").find("bump map"), std::string::npos);
}

}  // namespace
}  // namespace rayfarm
