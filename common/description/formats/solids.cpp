#include "common/description/formats/solids.h"

#include <numbers>

#include "common/description/formats/mesh_faces.h"
#include "common/math/portable_math.h"

namespace rayfarm {
namespace {

bool is_ring(std::span<const Vec2> profile) {
  return profile.front() == profile.back();
}

/// A lathe's mesh as it grows.
class Lathe {
 public:
  Lathe(std::span<const Vec2> profile, uint32_t sides, Smoothing smoothing, double crease)
      : profile_(profile),
        lines_(profile.size() - 1),
        sides_(sides),
        cosine_of_crease_(portable_cos(crease * std::numbers::pi / 180)),
        outward_(twice_area(loop_of_profile(profile)) > 0 ? 1 : -1) {
    mesh_.smoothing = smoothing;
  }

  MeshShape make() {
    for (size_t i = 0; i < profile_.size(); ++i) {
      first_point_.push_back(static_cast<uint32_t>(mesh_.positions.size()));
      if (i == lines_ && is_ring(profile_)) {
        first_point_.back() = first_point_.front();
        continue;
      }
      const Vec2& p = profile_[i];
      for (uint32_t j = 0; j < (p.x == 0 ? 1 : sides_); ++j) {
        const auto [sine, cosine] = portable_sine_cosine(angle(j));
        mesh_.positions.emplace_back(p.x * cosine, p.y, p.x * sine);
      }
    }
    for (size_t line = 0; line < lines_; ++line)
      if (profile_[line].x > 0 || profile_[line + 1].x > 0) add_line(line);
    if (!is_ring(profile_)) {
      add_lid(0);
      add_lid(lines_);
    }
    return std::move(mesh_);
  }

 private:
  double angle(double step) const { return 2 * std::numbers::pi * step / sides_; }

  uint32_t point(size_t i, uint32_t j) const {
    return first_point_[i] + (profile_[i].x == 0 ? 0 : j % sides_);
  }

  /// Of a line: across it, outward, unit.
  Vec2 normal_of(size_t line) const {
    const Vec2 along = outward_ * (profile_[line + 1] - profile_[line]);
    return glm::normalize(Vec2(along.y, -along.x));
  }

  /// Of a line where it begins or ends.
  Vec2 normal_at(size_t line, bool at_end) const {
    const Vec2 own = normal_of(line);
    const Vec2& end = profile_[at_end ? line + 1 : line];
    Vec2 other;
    if (end.x == 0) {  // the line that goes on beyond the axis
      other = {-own.x, own.y};
    } else if (at_end ? line + 1 < lines_ : line > 0) {
      other = normal_of(at_end ? line + 1 : line - 1);
    } else if (is_ring(profile_)) {
      other = normal_of(at_end ? 0 : lines_ - 1);
    } else {
      return own;  // beyond it is a lid
    }
    return glm::dot(own, other) >= cosine_of_crease_ ? glm::normalize(own + other) : own;
  }

  /// A place among the mesh's normals.
  uint32_t add_normal(const Vec2& in_profile, double step) {
    const auto [sine, cosine] = portable_sine_cosine(angle(step));
    mesh_.normals.emplace_back(in_profile.x * cosine, in_profile.y, in_profile.x * sine);
    return static_cast<uint32_t>(mesh_.normals.size() - 1);
  }

  void add_line(size_t line) {
    const bool is_smooth = mesh_.smoothing != Smoothing::flat;
    const auto first_normal = static_cast<uint32_t>(mesh_.normals.size());
    if (is_smooth)
      for (const bool at_end : {false, true}) {
        const bool is_tip = profile_[at_end ? line + 1 : line].x == 0;
        for (uint32_t j = 0; j < sides_; ++j)  // a tip has no direction of its own: the middle's of its face
          add_normal(normal_at(line, at_end), is_tip ? j + 0.5 : j);
      }
    for (uint32_t j = 0; j < sides_; ++j) {
      const auto corner = [&](bool at_end, uint32_t step) {
        const size_t i = at_end ? line + 1 : line;
        const uint32_t normal =
            first_normal + (at_end ? sides_ : 0) + (profile_[i].x == 0 ? j : step % sides_);
        return FaceCorner{point(i, step), is_smooth ? normal : ~0u};
      };
      std::vector<FaceCorner> corners{corner(false, j), corner(true, j)};
      if (profile_[line + 1].x > 0) corners.push_back(corner(true, j + 1));
      if (profile_[line].x > 0) corners.push_back(corner(false, j + 1));
      add(corners, outward_ < 0);
    }
  }

  void add_lid(size_t end) {
    if (profile_[end].x == 0) return;
    std::vector<FaceCorner> corners;
    for (uint32_t j = 0; j < sides_; ++j) corners.push_back({point(end, j)});
    // Steps run from +x to +z, clockwise seen from above.
    const bool is_above = (end == lines_) == (outward_ > 0);
    add(corners, is_above);
  }

  void add(std::vector<FaceCorner>& corners, bool is_reversed) {
    if (is_reversed) std::reverse(corners.begin(), corners.end());
    add_face(mesh_, corners);
  }

  std::span<const Vec2> profile_;
  size_t lines_;
  uint32_t sides_;
  double cosine_of_crease_;
  double outward_;                     ///< 1: outside lies to the right of who follows the profile
  std::vector<uint32_t> first_point_;  ///< of each of the profile's points; one that is on the axis has one
  MeshShape mesh_;
};

}  // namespace

double twice_area(std::span<const Vec2> polygon) {
  double sum = 0;
  for (size_t i = 1; i + 1 < polygon.size(); ++i) {
    const Vec2 a = polygon[i] - polygon[0], b = polygon[i + 1] - polygon[0];
    sum += a.x * b.y - a.y * b.x;
  }
  return sum;
}

std::vector<Vec2> loop_of_profile(std::span<const Vec2> profile) {
  std::vector<Vec2> loop(profile.begin(), profile.end());
  if (is_ring(profile)) {
    loop.pop_back();
    return loop;
  }
  for (const Vec2& end : {profile.back(), profile.front()})
    if (end.x > 0) loop.emplace_back(0, end.y);
  return loop;
}

MeshShape make_lathe(std::span<const Vec2> profile, uint32_t sides, Smoothing smoothing, double crease) {
  return Lathe(profile, sides, smoothing, crease).make();
}

MeshShape make_prism(std::span<const Vec2> polygon, double height) {
  MeshShape mesh;
  std::vector<Vec2> outline(polygon.begin(), polygon.end());
  if (twice_area(outline) > 0) std::reverse(outline.begin(), outline.end());  // z runs down seen from above
  const auto n = static_cast<uint32_t>(outline.size());
  std::vector<FaceCorner> floor, roof;
  for (uint32_t i = 0; i < n; ++i) {
    mesh.positions.emplace_back(outline[i].x, 0, outline[i].y);
    mesh.positions.emplace_back(outline[i].x, height, outline[i].y);
    floor.push_back({2 * (n - 1 - i)});
    roof.push_back({2 * i + 1});
  }
  add_face(mesh, floor);
  add_face(mesh, roof);
  for (uint32_t i = 0; i < n; ++i) {
    const uint32_t next = (i + 1) % n;
    const std::array<FaceCorner, 4> wall{{{2 * i}, {2 * next}, {2 * next + 1}, {2 * i + 1}}};
    add_face(mesh, wall);
  }
  return mesh;
}

}  // namespace rayfarm
