#include "host/experiments/smoothing/smoothing_experiment.h"

#include <fmt/core.h>

#include <cstdlib>
#include <filesystem>

#include "common/errors/input_error.h"
#include "common/lighting/face_corners.h"
#include "host/experiments/page.h"
#include "host/experiments/plots.h"
#include "host/experiments/smoothing/shaded_ball.h"
#include "host/files/text_file.h"
#include "host/instrument/table.h"
#include "host/process/exit_code.h"

namespace rayfarm {
namespace {

namespace fs = std::filesystem;

constexpr int kSide_px = 96;
constexpr size_t kProfilePoints = 1200;
constexpr int kProfileFrame = 7;

/// Points that turn with the ball, and the normals of their polygons.
struct BodyPoint {
  Vec3 p, normal;
};

/// Over all polygons, up to near their edges. `is_dense`: three rings of two a side, not one of one.
std::vector<BodyPoint> body_points(const Scene& scene, bool is_dense) {
  std::vector<BodyPoint> result;
  for (const MeshFace& face : scene.mesh_faces) {
    const Gathered<Vec3> points = points_of(scene, face);
    const auto corners = points.span();
    const Vec3 normal = normalized(newell_normal(corners));
    Vec3 center(0);
    for (const Vec3& p : corners) center += p / static_cast<double>(corners.size());
    for (size_t i = 0; i < corners.size(); ++i) {
      const Vec3 edge = corners[(i + 1) % corners.size()] - corners[i];
      for (const double outward : {0.7, 0.35, 0.95})
        for (const double along : {0.3, 0.8}) {
          if (!is_dense && (outward != 0.7 || along != 0.3)) continue;
          result.push_back({center + outward * (corners[i] + along * edge - center), normal});
        }
    }
  }
  return result;
}

/// How the light of points changes that turn with the ball.
struct Changes {
  std::vector<double> by_frame;  ///< the largest from each frame to the next
  double largest = 0;            ///< of them
  double sway = 0;               ///< between any two frames
};

/// Of points where and while they are seen.
Changes changes_on_body(ShadedBall& ball, std::span<const BodyPoint> points) {
  constexpr double kLeastCosine = 0.2;  // to the viewer: nearer to the rim little is seen of a polygon
  std::vector<double> before(points.size(), -1), least(points.size(), 2), most(points.size(), -1);
  Changes changes;
  for (int frame = 0; frame <= kBallFrames; ++frame) {
    ball.set_frame(frame);
    double largest = 0;
    for (size_t i = 0; i < points.size(); ++i) {
      const Vec3 p = ball.in_world(points[i].p);
      const Vec3 tip = ball.in_world(points[i].p + points[i].normal);
      const Vec3 to_point = normalized(p - ShadedBall::eye());
      const bool is_seen = -glm::dot(tip - p, to_point) > kLeastCosine;
      const double now = is_seen ? ball.intensity({ShadedBall::eye(), to_point}) : -1;
      if (is_seen) {
        least[i] = std::min(least[i], now);
        most[i] = std::max(most[i], now);
        changes.sway = std::max(changes.sway, most[i] - least[i]);
        if (before[i] >= 0) largest = std::max(largest, std::abs(now - before[i]));
      }
      before[i] = now;
    }
    if (frame == 0) continue;
    changes.by_frame.push_back(largest);
    changes.largest = std::max(changes.largest, largest);
  }
  return changes;
}

/// The same at the pixels of a picture, as far as the ball fills it in all frames.
double change_at_pixels(ShadedBall& ball, int side_px) {
  constexpr double kRadius = 0.7;  // of half the picture; the ball's rim is at 0.9
  std::vector<double> before;
  double largest = 0;
  for (int frame = 0; frame <= kBallFrames; ++frame) {
    ball.set_frame(frame);
    const Camera camera = ball.camera(side_px);
    std::vector<double> now;
    const double half = 0.5 * side_px;
    for (int y = 0; y < side_px; ++y)
      for (int x = 0; x < side_px; ++x)
        if (glm::length(Vec2(x + 0.5 - half, y + 0.5 - half)) < kRadius * half)
          now.push_back(ball.intensity(camera.ray(x + 0.5, y + 0.5)));
    for (size_t i = 0; i < before.size(); ++i) largest = std::max(largest, std::abs(now[i] - before[i]));
    before.swap(now);
  }
  return largest;
}

/// The light along a line of the picture.
struct Profile {
  std::vector<double> light;
  double step = 0;  ///< between points, in pictures' widths

  /// Per picture's width, between points i and i + 1.
  double slope(size_t i) const { return (light[i + 1] - light[i]) / step; }
  double largest_step() const {
    double largest = 0;
    for (size_t i = 0; i + 1 < light.size(); ++i)
      largest = std::max(largest, std::abs(light[i + 1] - light[i]));
    return largest;
  }
  double largest_kink() const {
    double largest = 0;
    for (size_t i = 0; i + 2 < light.size(); ++i)
      largest = std::max(largest, std::abs(slope(i + 1) - slope(i)));
    return largest;
  }
};

Profile profile_of(ShadedBall& ball, int frame) {
  constexpr double kBegin = 0.15, kEnd = 0.85, kHeight = 0.43;  // of the picture
  ball.set_frame(frame);
  const Camera camera = ball.camera(1);
  Profile profile;
  profile.step = (kEnd - kBegin) / (kProfilePoints - 1);
  for (size_t i = 0; i < kProfilePoints; ++i)
    profile.light.push_back(
        ball.intensity(camera.ray(kBegin + static_cast<double>(i) * profile.step, kHeight)));
  return profile;
}

struct Findings {
  ShadingMethod method{};
  Changes rolling, turning;  ///< about the line of sight, and about the vertical axis
  double largest_at_pixels = 0;
  Profile profile;
  double largest_step = 0, largest_kink = 0;  ///< along that line, over several frames
};

Findings examine(ShadingMethod method, int side_px) {
  const bool is_dense = side_px >= kSide_px / 2;
  Findings f;
  f.method = method;
  ShadedBall rolling(method, Vec3(0, 0, 1)), turning(method, Vec3(0, 1, 0));
  const std::vector<BodyPoint> points = body_points(rolling.scene(), is_dense);
  f.rolling = changes_on_body(rolling, points);
  f.turning = changes_on_body(turning, points);
  f.largest_at_pixels = change_at_pixels(rolling, side_px);
  f.profile = profile_of(rolling, kProfileFrame);
  for (int frame = 0; frame < kBallFrames; frame += is_dense ? 5 : 30) {
    const Profile profile = profile_of(rolling, frame);
    f.largest_step = std::max(f.largest_step, profile.largest_step());
    f.largest_kink = std::max(f.largest_kink, profile.largest_kink());
  }
  return f;
}

const char* const kPlots = R"(# gnuplot smoothing.gp
set terminal svg size 760,420 font "sans,12" background "white"
set grid
set key outside right
set output "jumps.svg"
set xlabel "frame"
set ylabel "largest change of a point's light"
set title "A ball that turns about the line of sight, the light at the eye: no change is the truth"
plot for [i=0:5] "jumps.dat" index i using 1:2 with lines lw 2 title columnheader(1)
set output "profile.svg"
set xlabel "across the picture"
set ylabel "light"
set title "Along a line of the picture"
plot for [i=0:5] "profile.dat" index i using 1:2 with lines title columnheader(1)
set output "slope.svg"
set yrange [-8:8]
set ylabel "slope of the light, per picture's width"
set title "Its slope: where it jumps the eye sees Mach bands"
plot for [i=1:5] "profile.dat" index i using 1:3 with lines title columnheader(1)
)";

void write_plots(std::span<const Findings> findings, const fs::path& folder) {
  std::string jumps, profiles;
  for (const Findings& f : findings) {
    jumps += fmt::format("\"{}\"\n", name_of(f.method));
    for (size_t i = 0; i < f.rolling.by_frame.size(); ++i)
      jumps += fmt::format("{} {:.6f}\n", i + 1, f.rolling.by_frame[i]);
    jumps += "\n\n";
    profiles += fmt::format("\"{}\"\n", name_of(f.method));
    for (size_t i = 0; i + 1 < f.profile.light.size(); i += 2)
      profiles += fmt::format("{:.4f} {:.5f} {:.4f}\n", 0.15 + static_cast<double>(i) * f.profile.step,
                              f.profile.light[i], f.profile.slope(i));
    profiles += "\n\n";
  }
  write_text_file((folder / "jumps.dat").string(), jumps);
  write_text_file((folder / "profile.dat").string(), profiles);
  draw_plots(folder, "smoothing.gp", kPlots);
}

std::string page_of(std::span<const Findings> findings, int side_px) {
  const auto of = [&](ShadingMethod method) { return findings[static_cast<size_t>(method)]; };
  std::string page = fmt::format(
      "# Smooth shading of a turning mesh\n\nWritten by `rayfarm experiment smoothing`; `deploy/reproduce "
      "smoothing` runs it again. A ball of twelve pentagons and twenty hexagons, white and diffuse, turns by "
      "{} degrees a frame for {} frames; the one source stands at the eye and gives 1 to what faces it. "
      "`flat`, `gouraud`, `phong` and `center` are the values of `smooth`. `by lines` are Gouraud's and "
      "Phong's methods as they were published (thesis, Figure 2.11b): between the two edges that the "
      "picture's line through a point crosses. The renderer's own `gouraud` and `phong` take mean value "
      "coordinates in their place, which know no lines.\n\n"
      "- *rolls*: it turns about the line of sight. What a point of the ball shows should not change at all: "
      "the largest change of any point from a frame to the next; *sways*: between any two frames.\n"
      "- *turns*: the same about the vertical axis, where light changes by right, too.\n"
      "- *pixel*: the largest change at a pixel of {} × {} while it rolls.\n"
      "- *step*, *kink*: the largest jump of light, and of its slope (per picture's width), between "
      "neighbours of {} points along a line of the picture. Kinks are what the eye sees as Mach bands.\n\n"
      "| | rolls | sways | turns | pixel | step | kink |\n|---|---:|---:|---:|---:|---:|---:|\n",
      kDegreesPerFrame, kBallFrames, side_px, side_px, kProfilePoints);
  for (const Findings& f : findings)
    page +=
        fmt::format("| {} | {:.4f} | {:.4f} | {:.4f} | {:.4f} | {:.4f} | {} |\n", name_of(f.method),
                    f.rolling.largest, f.rolling.sway, f.turning.largest, f.largest_at_pixels, f.largest_step,
                    f.method == ShadingMethod::flat ? "" : fmt::format("{:.2f}", f.largest_kink));
  const Findings center = of(ShadingMethod::center), phong = of(ShadingMethod::phong),
                 gouraud_lines = of(ShadingMethod::gouraud_by_lines),
                 phong_lines = of(ShadingMethod::phong_by_lines);
  page += fmt::format(
      "\n![changes from frame to frame](jumps.svg) ![light along a line](profile.svg) ![its "
      "slope](slope.svg)\n\n## The thesis's claims (2.3.5)\n\n"
      "- \"The values obtained using Phong or Gouraud shading are dependent on the orientation of the "
      "polygon "
      "in space\": by lines a point's light changes by up to {:.4f} (Gouraud) and {:.4f} (Phong) in a frame "
      "in "
      "which nothing should change, and sways by up to {:.3f} and {:.3f}.\n"
      "- \"The averaging algorithm is independent of the orientation\": with the centre normal it changes by "
      "{:.0e}, which is rounding. So it does with mean value coordinates ({:.0e}).\n"
      "- \"Eliminating the abrupt intensity changes (Mach Bands)\": those in time, yes. Along a line the "
      "slope of the centre normal's light jumps by up to {:.2f}, that of Phong's by lines by {:.2f}, of the "
      "renderer's own Phong by {:.2f}, of Gouraud's by lines by {:.2f}: the centre normal is linear in "
      "triangles between the polygon's middle and its edges, and bends where they meet.\n",
      gouraud_lines.rolling.largest, phong_lines.rolling.largest, gouraud_lines.rolling.sway,
      phong_lines.rolling.sway, center.rolling.largest, phong.rolling.largest, center.largest_kink,
      phong_lines.largest_kink, phong.largest_kink, gouraud_lines.largest_kink);
  return page;
}

}  // namespace

int run_smoothing_experiment(const ExperimentOptions& options) {
  const fs::path folder = make_page_folder(options.output);
  const int side_px = options.width_px > 0 ? options.width_px : kSide_px;
  std::vector<Findings> findings;
  for (const ShadingMethod method : kShadingMethods) findings.push_back(examine(method, side_px));
  Table table{"smoothing", {"method", "rolls", "sways", "turns", "pixel", "step", "kink"}, {}};
  for (const Findings& f : findings)
    table.rows.push_back({std::string(name_of(f.method)), f.rolling.largest, f.rolling.sway,
                          f.turning.largest, f.largest_at_pixels, f.largest_step, f.largest_kink});
  write_text_file((folder / "smoothing.csv").string(), format_tables({table}, TableFormat::csv));
  write_plots(findings, folder);
  write_text_file((folder / "README.md").string(), page_of(findings, side_px));
  fmt::print("{}\n", (folder / "README.md").string());
  return kComplete;
}

}  // namespace rayfarm
