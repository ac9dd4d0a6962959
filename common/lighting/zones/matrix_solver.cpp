// The full matrix (Goral and others 1984; the thesis's 2.2.5, Equation 2.6). For power per area B the
// equation is B_j = E_j + K_Dj Σ F_j,i B_i: with F as the thesis has it, "fraction of light leaving surface i
// and falling on surface j", 2.6 holds for power, and A_i F_i,j = A_j F_j,i makes one of the other.
#include <fmt/core.h>

#include "common/lighting/zones/form_factors.h"
#include "common/lighting/zones/measured_light.h"
#include "common/lighting/zones/shooting.h"
#include "common/lighting/zones/zone_solution.h"
#include "common/lighting/zones/zone_solver.h"

namespace rayfarm {
namespace {

/// Sweeps end when nothing changes by more than this part of the most that shines by itself.
constexpr double kLeastChange = 1e-6;
constexpr uint64_t kMostSweeps = 2000;

/// Of a form factor on the host.
constexpr uint64_t kFormFactorBytes = sizeof(uint32_t) + sizeof(double);

class MatrixSolver : public ZoneSolver {
 public:
  MatrixSolver(const Scene& scene, const RenderSettings& settings, int frame)
      : settings_(settings), zones_(scene, settings, frame), measured_(zones_), rows_(surface_slots()) {
    const uint64_t rays = form_factor_rays(settings_.zones, surface_slots());
    const double bytes = static_cast<double>(surface_slots()) *
                         static_cast<double>(std::min(rays, surface_slots()) * kFormFactorBytes);
    if (surface_slots() > kNone || bytes > static_cast<double>(settings_.zones.most_bytes()))
      throw std::runtime_error(fmt::format(
          "a matrix of {} sides of zones, each of which may see {} others, takes {:.3g} GiB, and {:g} GiB "
          "are "
          "allowed; a larger --zone-size, {}, or more --zone-memory, is needed",
          surface_slots(), std::min(rays, surface_slots()), bytes / 0x1p30, settings_.zones.most_GiB,
          settings_.zones.form_factors == FormFactors::rays ? "fewer --zone-rays" : "a smaller --hemicube"));
  }

  std::optional<ZoneStage> next_stage() override {
    if (stage_ == ZoneStageKind::light) solved_.push_back(solve(solved_.size()));
    if (solved_.size() == zones_.passes()) return std::nullopt;
    PackedWriter out;
    if (!stage_ && surface_slots() > 0) {
      const uint64_t rays = form_factor_rays(settings_.zones, surface_slots());
      stage_ = ZoneStageKind::count_hits;
      units_per_item_ = std::max<uint64_t>(1, settings_.zones.batch / rays);
      rays_ += rays * surface_slots();
      write(out, ZoneStageHead{ZoneStageKind::count_hits, 0, 0, {}, 0, 1});
      return ZoneStage{"form factors", out.take(), surface_slots(), units_per_item_};
    }
    stage_ = ZoneStageKind::light;
    units_per_item_ = std::max<uint64_t>(1, settings_.zones.batch / (uint64_t{2} * settings_.zones.samples));
    measured_.begin(units_per_item_);
    write(out, ZoneStageHead{ZoneStageKind::light, static_cast<uint32_t>(solved_.size()), 0, {}, 0, 1});
    return ZoneStage{"light from sources", out.take(), measured_.units(), units_per_item_};
  }

  void add(uint64_t item, std::span<const std::byte> result) override {
    if (stage_ == ZoneStageKind::light) {
      measured_.add(item, result);
      return;
    }
    PackedReader in(result);
    const uint64_t first = item * units_per_item_, end = std::min(surface_slots(), first + units_per_item_);
    std::vector<Row> rows;
    for (uint64_t slot = first; slot < end; ++slot) {
      const FormFactorRow row = read_form_factors(in, surface_slots());
      Row& kept = rows.emplace_back();
      if (row.total == 0) continue;
      const auto total = static_cast<double>(row.total);
      kept.escaped = static_cast<double>(row.escaped) / total;
      for (const FormFactorRow::Seen& seen : row.seen) {
        kept.seen.push_back(static_cast<uint32_t>(seen.slot));
        kept.form_factors.push_back(static_cast<double>(seen.weight) / total);
      }
    }
    in.expect_end();
    std::move(rows.begin(), rows.end(), rows_.begin() + static_cast<std::ptrdiff_t>(first));
  }

  ZoneProgress progress() const override { return {0, 1, rays_}; }
  std::vector<std::byte> solution() const override { return encode_zone_solution(solved_); }

 private:
  struct Row {
    std::vector<uint32_t> seen;
    std::vector<double> form_factors;
    double escaped = 0;
  };

  uint64_t surface_slots() const { return zones_.map().slot_count(); }

  Color seen_by(uint64_t slot, std::span<const Color> leaving) const {
    const Row& row = rows_[slot];
    Color sum(0);
    for (size_t k = 0; k < row.seen.size(); ++k) sum += row.form_factors[k] * leaving[row.seen[k]];
    return sum;
  }

  /// Calls visit(first slot, area, albedo) for cells of which there is something.
  template <typename Visit>
  void for_each_cell(const ZoneColors& colors, Visit visit) const {
    for (const ZoneGrid& grid : zones_.map().grids()) {
      if (!grid.store.is_diffuse) continue;
      for (uint32_t cell = 0; cell < grid.cell_count; ++cell)
        if (const double area = zones_.map().area(grid, cell); area > 0)
          visit(grid.slot(cell, 0), area, colors(grid, cell));
    }
  }

  /// What both sides of a cell reflect and let through of what they see.
  std::array<Color, 2> reflected_by(uint64_t slot, const ZoneAlbedo& albedo,
                                    std::span<const Color> leaving) const {
    const std::array<Color, 2> seen{seen_by(slot, leaving), seen_by(slot + 1, leaving)};
    return {albedo.reflected[0] * seen[0] + albedo.through * seen[1],
            albedo.reflected[1] * seen[1] + albedo.through * seen[0]};
  }

  ZonePassSolution solve(size_t pass) const {
    const Scene& scene = zones_.scene(pass);
    const ZoneColors colors(scene, zones_.map());
    ZonePassSolution result(zones_.slot_count());
    const auto shot = find_shot(zones_, scene, settings_.zones);
    Color primary = measured_.total();
    for (const auto& [slot, power] : shot) primary += power;
    result.quantum = ZoneQuantum(primary);
    const ZoneQuantum& quantum = result.quantum;

    // What shines by itself, and that with what it gets straight from sources: power, then power per area.
    std::vector<Color> emitted(surface_slots(), Color(0)), own = emitted;
    measured_.for_each([&](const Color& followed) { result.primary += quantum.quantized(followed); },
                       [&](uint64_t slot, const Color& direct, const Color& by_chance) {
                         const Power straight = quantum.quantized(direct);
                         Power both = straight;
                         both += quantum.quantized(by_chance);
                         result.direct[slot] += straight;
                         result.total[slot] += both;
                         result.primary += both;
                         if (slot < surface_slots()) own[slot] += direct + by_chance;
                       });
    for (const auto& [slot, power] : shot) {
      result.primary += quantum.quantized(power);
      emitted[slot] += power;
      own[slot] += power;
    }
    Color most(0);
    for_each_cell(colors, [&](uint64_t slot, double area, const ZoneAlbedo&) {
      for (const uint64_t side : {slot, slot + 1}) {
        emitted[side] /= area;
        own[side] /= area;
        most = glm::max(most, own[side]);
      }
    });

    // Gauss and Seidel: each zone's equation in turn, with what is known by then of the others.
    std::vector<Color> leaving = own;
    Color changed(0);
    for (bool is_still = false; !is_still && result.rounds < kMostSweeps; ++result.rounds) {
      is_still = true;
      changed = Color(0);
      for_each_cell(colors, [&](uint64_t slot, double area, const ZoneAlbedo& albedo) {
        const std::array<Color, 2> reflected = reflected_by(slot, albedo, leaving);
        for (size_t side = 0; side < 2; ++side) {
          const Color now = own[slot + side] + reflected[side];
          const Color change = glm::abs(now - leaving[slot + side]);
          leaving[slot + side] = now;
          changed += change * area;
          for (int c = 0; c < 3; ++c) is_still &= change[c] <= kLeastChange * most[c];
        }
      });
    }

    // Rays or pixels sample F: sums of power that follow from it are right but for their noise, so what is
    // absorbed is told as the rest.
    Color escaped(0);
    for_each_cell(colors, [&](uint64_t slot, double area, const ZoneAlbedo& albedo) {
      const std::array<Color, 2> reflected = reflected_by(slot, albedo, leaving);
      const std::array<Color, 2> from_shot =
          shot.empty() ? std::array{Color(0), Color(0)} : reflected_by(slot, albedo, emitted);
      for (size_t side = 0; side < 2; ++side) {
        result.total[slot + side] += quantum.quantized(checked(reflected[side] * area, primary));
        if (!shot.empty())
          result.direct[slot + side] += quantum.quantized(checked(from_shot[side] * area, primary));
        escaped += leaving[slot + side] * (area * rows_[slot + side].escaped);
      }
    });
    result.escaped = quantum.quantized(checked(escaped, primary));
    result.unsent = quantum.quantized(checked(changed, primary));
    result.absorbed = result.primary;
    result.absorbed -= result.escaped;
    result.absorbed -= result.unsent;
    return result;
  }

  /// A sum of all zones' power has room in 63 bits as long as light is reflected fewer than 1024 times.
  static const Color& checked(const Color& power, const Color& primary) {
    for (int c = 0; c < 3; ++c)
      if (!(power[c] <= 1024 * primary[c]))
        throw std::runtime_error(
            "zones reflect all light that they get, so it never comes to rest; darker materials are needed");
    return power;
  }

  RenderSettings settings_;
  ZoneScene zones_;
  MeasuredLight measured_;
  std::vector<Row> rows_;  ///< by slot
  std::vector<ZonePassSolution> solved_;
  uint64_t rays_ = 0;
  std::optional<ZoneStageKind> stage_;  ///< that is worked on
  uint64_t units_per_item_ = 1;
};

}  // namespace

std::unique_ptr<ZoneSolver> make_matrix_solver(const Scene& scene, const RenderSettings& settings,
                                               int frame) {
  return std::make_unique<MatrixSolver>(scene, settings, frame);
}

}  // namespace rayfarm
