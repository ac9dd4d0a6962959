// NFF (Haines, "Neutral File Format", version 3.9): tokens separated by white space, `#` to the end of the
// line. The text is cut into pieces where records begin, which all cores read.
#include <cmath>
#include <utility>

#include "common/description/formats/nff_piece.h"
#include "common/description/formats/nff_scene.h"
#include "common/description/formats/scene_loaders.h"
#include "common/description/formats/text_pieces.h"
#include "common/files/read_file.h"

namespace rayfarm {
namespace {

/// Joins the pieces of one file, in their order.
class SceneJoiner {
 public:
  explicit SceneJoiner(const std::string& path) {
    scene_.files = {path};
    scene_.objects.push_back({"nff", {}, {}, {0, 1, 1}});
  }

  NffBefore before() const { return {lines_, scene_.lights.size()}; }
  void make_room_for(size_t primitives) { scene_.objects[0].primitives.reserve(primitives); }

  void add(NffPiece piece) {
    add_primitives(piece);
    for (MaterialDescription& m : piece.materials) {
      m.name = fmt::format("f{}", scene_.materials.size() + 1);
      scene_.materials.push_back(std::move(m));
    }
    scene_.lights.insert(scene_.lights.end(), piece.lights.begin(), piece.lights.end());
    light_has_color_.insert(light_has_color_.end(), piece.light_has_color.begin(),
                            piece.light_has_color.end());
    if (piece.view) scene_.view = *piece.view;
    if (piece.background) scene_.background = *piece.background;
    for (const NffPiece::Mark& mark : piece.marks) tell(mark);
    lines_ += piece.lines;
  }

  SceneDescription finish() {
    if (!has_view_)
      throw InputError({scene_.files[0], 1, 1},
                       "the file has no view ('v' record), so there is nothing to render from");
    // The files give no intensities: n lights have sqrt(n)/(2n) each, and so has the ambient term (Haines,
    // SPD).
    const auto n = static_cast<double>(std::max<size_t>(1, scene_.lights.size()));
    const double level = std::sqrt(n) / (2 * n);
    scene_.ambient = Color(level);
    for (size_t i = 0; i < scene_.lights.size(); ++i)
      if (!light_has_color_[i]) scene_.lights[i].color = Color(level);
    if (scene_.materials.empty()) scene_.materials.emplace_back("default");
    return std::move(scene_);
  }

 private:
  void add_primitives(NffPiece& piece) {
    const bool has_plain = !piece.primitives.empty() && piece.primitives.front().material == 0;
    if (has_plain && scene_.materials.empty()) scene_.materials.emplace_back("default");
    for (PrimitiveDescription& p : piece.primitives) {
      p.material += static_cast<uint32_t>(scene_.materials.size()) - 1;
      p.place.line += lines_;
      scene_.objects[0].primitives.push_back(std::move(p));
    }
  }

  void tell(const NffPiece::Mark& mark) {
    const auto note = [&](std::string_view what) {
      scene_.notes.add({scene_.files[0], mark.place.line + lines_, mark.place.column}, what);
    };
    if (mark.kind == NffPiece::Kind::view) {
      if (std::exchange(has_view_, true)) note("this view takes the place of the one before it");
    } else if (mark.kind == NffPiece::Kind::background) {
      if (std::exchange(has_background_, true)) note("this background takes the place of the one before it");
    } else if (!std::exchange(has_inside_note_, true)) {
      note("the sign of a negative radius is not used: surfaces are seen from both sides");
    }
  }

  SceneDescription scene_;
  std::vector<bool> light_has_color_;
  bool has_view_ = false, has_background_ = false, has_inside_note_ = false;
  int lines_ = 0;
};

}  // namespace

SceneDescription read_nff_scene(std::string_view text, const std::string& path,
                                std::span<const size_t> borders, const std::stop_token& stop,
                                ReadProgress* progress) {
  const std::vector<std::string_view> texts = cut_text(text, borders, begins_nff_record);
  std::vector<NffPiece> pieces = read_pieces<NffPiece>(
      texts, progress,
      [&](std::string_view piece, NffPiece& read) { read_nff_piece(piece, path, {}, stop, read); });
  size_t primitives = 0;
  for (const NffPiece& piece : pieces) primitives += piece.primitives.size();
  SceneJoiner joiner(path);
  joiner.make_room_for(primitives);
  for (size_t i = 0; i < pieces.size(); ++i) {
    throw_if_stopped(stop);
    if (pieces[i].is_broken || joiner.before().lights + pieces[i].lights.size() > limits::kLights) {
      // It throws, knowing its place. A record that lacks something goes on in the next piece.
      NffPiece again;
      const auto begin = static_cast<size_t>(texts[i].data() - text.data());
      read_nff_piece(text.substr(begin), path, joiner.before(), stop, again);
    }
    joiner.add(std::move(pieces[i]));
  }
  return joiner.finish();
}

SceneDescription load_nff_scene(const std::string& path, const LoadOptions& options) {
  const FileText file = read_large_text_file(path, limits::kFileBytes, options.stop);
  return read_nff_scene(file.text(), path, borders_of_pieces(file.text().size()), options.stop,
                        options.progress);
}

}  // namespace rayfarm
