#include "tests/fuzz/zone_bytes.h"

#include <fstream>

#include "common/compile/compile.h"
#include "common/description/formats/scene_loaders.h"
#include "common/files/read_file.h"
#include "common/lighting/renderer.h"
#include "common/lighting/zones/zone_solver.h"
#include "host/process/exit_code.h"
#include "host/render/zones_file.h"
#include "protocol/protocol_error.h"

namespace rayfarm::fuzz {
namespace {

// Diffuse light, directions, a mirror, a medium with directions, and what shines.
constexpr const char* kZonedScene =
    "view: {location: [0, 0, 0.9], look_at: [0, 0, -1], aspect: 1}\n"
    "materials:\n  wall: {lambertian: 0.5}\n  gold: {conductor: {metal: gold, exponent: 10}}\n"
    "  mirror: {conductor: {metal: silver}}\n  lamp: {luminaire: {color: 0.5, emission: 2}}\n"
    "media: [{box: {min: [-1, -1, -1], max: [0, 0, 0]}, scattering: 0.5, absorption: 0.1, g: 0.3}]\n"
    "scene:\n"
    "  - {material: wall, polygon: {points: [[-1,-1,-1],[-1,-1,1],[1,-1,1],[1,-1,-1]]}}\n"
    "  - {material: lamp, polygon: {points: [[-1,1,-1],[1,1,-1],[1,1,1],[-1,1,1]]}}\n"
    "  - {material: gold, polygon: {points: [[-1,-1,-1],[1,-1,-1],[1,1,-1],[-1,1,-1]]}}\n"
    "  - {material: mirror, polygon: {points: [[1,-1,-1],[1,-1,1],[1,1,1],[1,1,-1]]}}\n";

/// What the first byte of an input names.
enum Kind : char { kStage = 's', kLight = 'l', kResult = 'r', kSolution = 'p', kFile = 'f' };
/// The second: 'z', or 'm' of the full matrix.
constexpr char kModels[] = {'z', 'm'};

struct Zoned {
  explicit Zoned(const std::string& folder) {
    const std::string file = folder + "/zoned.yaml";
    std::ofstream(file) << kZonedScene;
    compiled = compile(load_scene(file));
  }
  RenderSettings settings(char model) const {
    RenderSettings s;
    s.lighting = model == 'm' ? LightingModel::radiosity : LightingModel::zonal;
    limit_by_depth(s, 8);
    s.zones.size = 2;
    s.zones.rays = 40;
    s.zones.samples = 1;
    s.zones.tolerance = 0.1;
    s.zones.primary = ZonePrimary::shot;
    s.width_px = s.height_px = 2;
    s.crop = {0, 0, 2, 2};
    return s;
  }
  ZonesFile file(const std::string& folder) const {
    return {folder + "/in.zones", compiled.scene, settings('z'), false};
  }
  CompiledScene compiled;
};

const Zoned& zoned(const std::string& folder) {
  static const Zoned scene(folder);
  return scene;
}

/// Works as a farm does, until `visit(stage, number)` is false, and gives it all results.
template <typename VisitStage, typename VisitResult>
std::unique_ptr<ZoneSolver> solve(const Scene& scene, const RenderSettings& settings, VisitStage visit_stage,
                                  VisitResult visit_result) {
  std::unique_ptr<ZoneSolver> solver = make_zone_solver(scene, settings, 0);
  const std::unique_ptr<ZoneTracer> tracer = make_zone_tracer(scene, settings, 0);
  int number = 0;
  while (const auto stage = solver->next_stage()) {
    if (!visit_stage(*stage, number)) return solver;
    tracer->begin(stage->data);
    for (uint64_t item = 0; item < stage->items(); ++item) {
      const uint64_t first = item * stage->units_per_item;
      const auto result =
          tracer->work(first, std::min(stage->units_per_item, stage->units - first), [] {}).bytes;
      visit_result(result, number);
      solver->add(item, result);
    }
    ++number;
  }
  return solver;
}

std::string tagged(Kind kind, char model, std::span<const std::byte> bytes) {
  return std::string{kind, model} + std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size());
}

/// A damaged stage at a node, and as many of its units as there may be.
void work_on(const Scene& scene, const RenderSettings& settings, std::span<const std::byte> bytes) {
  const std::unique_ptr<ZoneTracer> tracer = make_zone_tracer(scene, settings, 0);
  tracer->begin(bytes);
  for (const uint64_t count : {1, 2}) tracer->work(0, count, [] {});
}

/// A damaged result at the host, in the first stage of its kind; then what goes on with it.
void add_to(const Scene& scene, const RenderSettings& settings, Kind kind, std::span<const std::byte> bytes) {
  const std::unique_ptr<ZoneSolver> solver = solve(
      scene, settings, [&](const ZoneStage&, int number) { return number < (kind == kLight ? 0 : 1); },
      [](const auto&, int) {});
  solver->add(0, bytes);
  for (int i = 0; i < 3 && solver->next_stage(); ++i) {
  }
}

}  // namespace

std::vector<std::string> zone_seeds(const std::string& folder) {
  const Zoned& z = zoned(folder);
  std::vector<std::string> seeds;
  for (const char model : kModels) {
    const auto solver = solve(
        z.compiled.scene, z.settings(model),
        [&](const ZoneStage& stage, int number) {
          if (number < 4) seeds.push_back(tagged(kStage, model, stage.data));
          return true;
        },
        [&](const std::vector<std::byte>& result, int number) {
          if (number < 4) seeds.push_back(tagged(number == 0 ? kLight : kResult, model, result));
        });
    const std::vector<std::byte> solution = solver->solution();
    seeds.push_back(tagged(kSolution, model, solution));
    if (model != 'z') continue;
    z.file(folder).write(FrameNumber(0), solution);
    seeds.push_back("fz" + read_file(folder + "/in.zones", 1 << 20));
  }
  return seeds;
}

void read_zones(const std::string& folder, const std::string& bytes) try {
  if (bytes.size() < 2) return;
  const Zoned& z = zoned(folder);
  const Scene& scene = z.compiled.scene;
  const RenderSettings settings = z.settings(bytes[1]);
  const auto rest = std::as_bytes(std::span(bytes).subspan(2));
  switch (bytes[0]) {
    case kStage:
      work_on(scene, settings, rest);
      break;
    case kLight:
    case kResult:
      add_to(scene, settings, static_cast<Kind>(bytes[0]), rest);
      break;
    case kSolution: {
      Renderer renderer(scene, settings);
      renderer.set_zones(0, rest);
      renderer.render(0, settings.crop, [] {});
      break;
    }
    case kFile:
      std::ofstream(folder + "/in.zones", std::ios::binary) << bytes.substr(2);
      z.file(folder).read(FrameNumber(0));
      break;
    default:
      break;
  }
} catch (const std::runtime_error& e) {
  throw ProtocolError(e.what());
}

}  // namespace rayfarm::fuzz
