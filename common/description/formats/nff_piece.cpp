#include "common/description/formats/nff_piece.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/description/formats/records.h"

namespace rayfarm {
namespace {

bool is_space(char c) {
  return c == ' ' || c == '\n' || c == '\r' || c == '\t' || c == '\f' || c == '\v';
}

/// Splits the text into tokens and knows the place of each.
class Tokens {
 public:
  Tokens(std::string_view text, const std::string& file, int lines_before)
      : text_(text), file_(file), line_(lines_before + 1) {}

  bool at_end() {
    skip_space();
    return position_ == text_.size();
  }
  std::string_view next(std::string_view expected) {
    if (at_end()) fail(fmt::format("the file ends where {} is expected", expected));
    const size_t begin = position_;
    token_line_ = line_;
    token_column_ = static_cast<int>(position_ - line_begin_) + 1;
    while (position_ < text_.size() && !is_space(text_[position_]) && text_[position_] != '#') ++position_;
    return text_.substr(begin, position_ - begin);
  }
  /// True if another token stands on the current line.
  bool more_on_line() {
    while (position_ < text_.size() && text_[position_] != '\n' && is_space(text_[position_])) ++position_;
    return position_ < text_.size() && text_[position_] != '\n' && text_[position_] != '#';
  }
  void keyword(std::string_view word) {
    const std::string_view token = next(fmt::format("'{}'", word));
    if (token != word) fail(fmt::format("expected '{}', found '{}'", word, token.substr(0, 40)));
  }
  double number(std::string_view what) {
    const std::string_view token = next(what);
    const std::optional<double> value = parse_number(token);
    if (!value) fail(fmt::format("expected a number ({}), found '{}'", what, token.substr(0, 40)));
    if (!std::isfinite(*value)) fail(fmt::format("{} is not a finite number", what));
    if (std::abs(*value) > limits::kCoordinate)
      fail(fmt::format("{} is larger than {:g}", what, limits::kCoordinate));
    return *value;
  }
  Vec3 vector(std::string_view what) {
    const double x = number(what), y = number(what);
    return {x, y, number(what)};
  }
  int count(std::string_view what, int least, size_t most) {
    const double value = number(what);
    if (value != std::floor(value) || value < least || value > static_cast<double>(most))
      fail(fmt::format("{} must be a whole number from {} to {}, not {:g}", what, least, most, value));
    return static_cast<int>(value);
  }
  int line() const { return line_; }  ///< that of what comes next
  Place place() const { return {0, token_line_, token_column_}; }
  [[noreturn]] void fail(const std::string& problem) const {
    throw InputError({file_, token_line_ ? token_line_ : 1, token_line_ ? token_column_ : 1}, problem);
  }

 private:
  void skip_space() {
    while (position_ < text_.size()) {
      if (text_[position_] == '\n') {
        ++line_;
        line_begin_ = ++position_;
      } else if (is_space(text_[position_])) {
        ++position_;
      } else if (text_[position_] == '#') {
        while (position_ < text_.size() && text_[position_] != '\n') ++position_;
      } else {
        return;
      }
    }
  }

  std::string_view text_;
  const std::string& file_;
  size_t position_ = 0, line_begin_ = 0;
  int line_, token_line_ = 0, token_column_ = 0;
};

void read_view(Tokens& tokens, ViewDescription& view) {
  tokens.keyword("from");
  view.location = constant_curve(Vec4(tokens.vector("from"), 0));
  tokens.keyword("at");
  view.look_at = constant_curve(Vec4(tokens.vector("at"), 0));
  tokens.keyword("up");
  view.up = constant_curve(Vec4(tokens.vector("up"), 0));
  tokens.keyword("angle");
  const double angle = tokens.number("angle");
  if (!(angle > 0 && angle < 180)) tokens.fail("the view angle must be between 0 and 180 degrees");
  tokens.keyword("hither");
  tokens.number("hither");  // a hidden-surface algorithm's near plane: a ray tracer has none
  tokens.keyword("resolution");
  const int width = tokens.count("resolution", 1, 65536);
  view.resolution_px = {width, tokens.count("resolution", 1, 65536)};
  // The angle spans the image's edges and the aspect ratio is 1 in every NFF file.
  view.field_of_view = constant_curve(Vec4(angle, 0, 0, 0));
  view.aspect = 1;
}

/// A negative radius means that only the inside is visible.
double read_radius(Tokens& tokens, std::string_view what, bool& is_inside) {
  const double radius = tokens.number(what);
  is_inside = is_inside || radius < 0;
  return std::abs(radius);
}

class PieceReader {
 public:
  PieceReader(std::string_view text, const std::string& path, const NffBefore& before,
              const std::stop_token& stop, NffPiece& piece)
      : tokens_(text, path, before.lines), before_(before), stop_(stop), piece_(piece) {}

  void read() {
    while (!tokens_.at_end()) {
      throw_if_stopped(stop_);
      is_inside_ = false;
      const std::string_view record = tokens_.next("a record");
      place_ = tokens_.place();
      read_record(record);
      if (is_inside_ && !std::exchange(has_inside_mark_, true)) mark(NffPiece::Kind::negative_radius);
    }
    piece_.lines = tokens_.line() - 1 - before_.lines;
  }

 private:
  void read_record(std::string_view record) {
    if (record == "p") {
      read_polygon(false);
    } else if (record == "pp") {
      read_polygon(true);
    } else if (record == "s") {
      const Vec3 center = tokens_.vector("centre");
      add(SphereShape{center, read_radius(tokens_, "radius", is_inside_)});
    } else if (record == "c") {
      ConeShape cone;
      cone.base = tokens_.vector("base");
      cone.base_radius = read_radius(tokens_, "base radius", is_inside_);
      cone.apex = tokens_.vector("apex");
      cone.apex_radius = read_radius(tokens_, "apex radius", is_inside_);
      add(cone);
    } else if (record == "f") {
      read_material();
    } else if (record == "l") {
      read_light();
    } else if (record == "v") {
      mark(NffPiece::Kind::view);
      read_view(tokens_, piece_.view.emplace());
    } else if (record == "b") {
      mark(NffPiece::Kind::background);
      piece_.background = tokens_.vector("background colour");
    } else {
      tokens_.fail(fmt::format("unknown record '{}'; NFF has v, b, l, f, c, s, p, pp and # comments",
                               record.substr(0, 40)));
    }
  }

  void read_light() {
    if (before_.lights + piece_.lights.size() == limits::kLights) tokens_.fail("too many lights");
    Light light;
    light.position = tokens_.vector("light position");
    piece_.light_has_color.push_back(tokens_.more_on_line());
    if (piece_.light_has_color.back()) light.color = tokens_.vector("light colour");
    piece_.lights.push_back(light);
  }

  void read_material() {
    MaterialDescription m;
    m.color = tokens_.vector("colour");
    m.ambient = m.diffuse = tokens_.number("Kd");
    m.specular = m.reflect = tokens_.number("Ks");
    m.shininess = tokens_.number("Shine");
    m.transmit = tokens_.number("T");
    m.index = tokens_.number("index of refraction");
    if (!(m.index > 0)) m.index = 1;  // the databases write 0 for opaque surfaces
    piece_.materials.push_back(std::move(m));
    mesh_ = kNone;
  }

  void read_polygon(bool has_normals) {
    points_.clear();
    normals_.clear();
    const int count = tokens_.count("number of vertices", 3, limits::kPolygonPoints);
    for (int i = 0; i < count; ++i) {
      points_.push_back(tokens_.vector("vertex"));
      if (has_normals) normals_.push_back(tokens_.vector("normal"));
    }
    if (count != 3 || has_normals || !add_to_mesh()) add(PolygonShape{points_, normals_});
  }

  /// False of a triangle without area, as it is stored: it keeps its place, where it is told of.
  bool add_to_mesh() {
    const std::array<glm::vec3, 3> v{glm::vec3(points_[0]), glm::vec3(points_[1]), glm::vec3(points_[2])};
    const Vec3 a(v[0]), b(v[1]), c(v[2]);
    if (max_magnitude(glm::cross(b - a, c - a)) == 0) return false;
    if (mesh_ == kNone) {
      const size_t i = piece_.primitives.size();
      add(MeshShape{});
      mesh_ = i;
    }
    auto& mesh = std::get<MeshShape>(piece_.primitives[mesh_].shape);
    const auto first = static_cast<uint32_t>(mesh.positions.size());
    mesh.positions.insert(mesh.positions.end(), v.begin(), v.end());
    mesh.triangles.emplace_back(first, first + 1, first + 2);
    return true;
  }

  void add(Shape shape) {
    piece_.primitives.push_back({std::move(shape), static_cast<uint32_t>(piece_.materials.size()), place_});
    mesh_ = kNone;
  }
  void mark(NffPiece::Kind kind) { piece_.marks.push_back({kind, place_}); }

  static constexpr size_t kNone = SIZE_MAX;
  Tokens tokens_;
  NffBefore before_;
  const std::stop_token& stop_;
  NffPiece& piece_;
  Place place_;          ///< of the record
  size_t mesh_ = kNone;  ///< which primitive the next triangle joins
  bool is_inside_ = false, has_inside_mark_ = false;
  std::vector<Vec3> points_, normals_;
};

}  // namespace

void read_nff_piece(std::string_view text, const std::string& path, const NffBefore& before,
                    const std::stop_token& stop, NffPiece& piece) {
  PieceReader(text, path, before, stop, piece).read();
}

bool begins_nff_record(std::string_view text, size_t at) {
  if (at > 0 && text[at - 1] != '\n') return false;
  while (at < text.size() && text[at] != '\n' && is_space(text[at])) ++at;
  size_t end = at;
  while (end < text.size() && end < at + 3 && !is_space(text[end]) && text[end] != '#') ++end;
  static constexpr std::string_view kRecords[] = {"v", "b", "l", "f", "c", "s", "p", "pp"};
  return std::ranges::find(kRecords, text.substr(at, end - at)) != std::end(kRecords);
}

}  // namespace rayfarm
