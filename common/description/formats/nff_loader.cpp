// NFF (Haines, "Neutral File Format", version 3.9): tokens separated by white space, `#` to the end of the
// line.
#include <cmath>
#include <utility>

#include "common/description/formats/records.h"
#include "common/description/formats/scene_loaders.h"
#include "common/files/read_file.h"

namespace rayfarm {
namespace {

/// Splits the text into tokens and knows the place of each.
class Tokens {
 public:
  Tokens(const std::string& text, const std::string& file, const std::stop_token& stop)
      : text_(text), file_(file), stop_(stop) {}

  bool at_end() {
    skip_space();
    return position_ == text_.size();
  }
  std::string_view next(std::string_view expected) {
    throw_if_stopped(stop_);
    if (at_end()) fail(fmt::format("the file ends where {} is expected", expected));
    const size_t begin = position_;
    token_line_ = line_;
    token_column_ = static_cast<int>(position_ - line_begin_) + 1;
    while (position_ < text_.size() && !is_space(text_[position_]) && text_[position_] != '#') ++position_;
    return std::string_view(text_).substr(begin, position_ - begin);
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
  Place place() const { return {0, token_line_, token_column_}; }
  [[noreturn]] void fail(const std::string& problem) const {
    throw InputError({file_, token_line_ ? token_line_ : 1, token_line_ ? token_column_ : 1}, problem);
  }

 private:
  static bool is_space(char c) {
    return c == ' ' || c == '\n' || c == '\r' || c == '\t' || c == '\f' || c == '\v';
  }
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

  const std::string& text_;
  const std::string& file_;
  const std::stop_token& stop_;
  size_t position_ = 0, line_begin_ = 0;
  int line_ = 1, token_line_ = 0, token_column_ = 0;
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

Shape read_polygon(Tokens& tokens, bool has_normals) {
  PolygonShape polygon;
  const int count = tokens.count("number of vertices", 3, limits::kPolygonPoints);
  for (int i = 0; i < count; ++i) {
    polygon.points.push_back(tokens.vector("vertex"));
    if (has_normals) polygon.normals.push_back(tokens.vector("normal"));
  }
  return polygon;
}

}  // namespace

SceneDescription load_nff_scene(const std::string& path, const std::stop_token& stop) {
  const std::string text = read_text_file(path, limits::kFileBytes, stop);
  Tokens tokens(text, path, stop);
  SceneDescription scene;
  scene.files = {path};
  scene.objects.push_back({"nff", {}, {}, {0, 1, 1}});
  std::vector<PrimitiveDescription>& primitives = scene.objects[0].primitives;
  std::vector<bool> light_has_color;
  bool has_view = false, has_background = false, has_inside_note = false;
  const auto add = [&](Shape shape, const Place& place) {
    if (scene.materials.empty()) scene.materials.emplace_back("default");
    primitives.push_back({std::move(shape), static_cast<uint32_t>(scene.materials.size() - 1), place});
  };

  while (!tokens.at_end()) {
    bool is_inside = false;
    const std::string_view record = tokens.next("a record");
    const Place place = tokens.place();
    const auto note = [&](std::string_view what) { scene.notes.add(scene.source(place), what); };
    if (record == "v") {
      if (has_view) note("this view takes the place of the one before it");
      read_view(tokens, scene.view);
      has_view = true;
    } else if (record == "b") {
      if (has_background) note("this background takes the place of the one before it");
      has_background = true;
      scene.background = tokens.vector("background colour");
    } else if (record == "l") {
      if (scene.lights.size() == limits::kLights) tokens.fail("too many lights");
      Light light;
      light.position = tokens.vector("light position");
      light_has_color.push_back(tokens.more_on_line());
      if (light_has_color.back()) light.color = tokens.vector("light colour");
      scene.lights.push_back(light);
    } else if (record == "f") {
      MaterialDescription m;
      m.name = fmt::format("f{}", scene.materials.size() + 1);
      m.color = tokens.vector("colour");
      m.ambient = m.diffuse = tokens.number("Kd");
      m.specular = m.reflect = tokens.number("Ks");
      m.shininess = tokens.number("Shine");
      m.transmit = tokens.number("T");
      m.index = tokens.number("index of refraction");
      if (!(m.index > 0)) m.index = 1;  // the databases write 0 for opaque surfaces
      scene.materials.push_back(m);
    } else if (record == "s") {
      const Vec3 center = tokens.vector("centre");
      add(SphereShape{center, read_radius(tokens, "radius", is_inside)}, place);
    } else if (record == "c") {
      ConeShape cone;
      cone.base = tokens.vector("base");
      cone.base_radius = read_radius(tokens, "base radius", is_inside);
      cone.apex = tokens.vector("apex");
      cone.apex_radius = read_radius(tokens, "apex radius", is_inside);
      add(cone, place);
    } else if (record == "p" || record == "pp") {
      add(read_polygon(tokens, record == "pp"), place);
    } else {
      tokens.fail(fmt::format("unknown record '{}'; NFF has v, b, l, f, c, s, p, pp and # comments",
                              record.substr(0, 40)));
    }
    if (is_inside && !std::exchange(has_inside_note, true))
      note("the sign of a negative radius is not used: surfaces are seen from both sides");
  }
  if (!has_view)
    throw InputError({path, 1, 1}, "the file has no view ('v' record), so there is nothing to render from");

  // The files give no intensities: n lights have sqrt(n)/(2n) each, and so has the ambient term (Haines,
  // SPD).
  const auto n = static_cast<double>(std::max<size_t>(1, scene.lights.size()));
  const double level = std::sqrt(n) / (2 * n);
  scene.ambient = Color(level);
  for (size_t i = 0; i < scene.lights.size(); ++i)
    if (!light_has_color[i]) scene.lights[i].color = Color(level);
  if (scene.materials.empty()) scene.materials.emplace_back("default");
  return scene;
}

}  // namespace rayfarm
