// Geomview's OFF (Phillips, Levy and Munzner 1996), in three dimensions and in text: a word like STCNOFF, how
// many vertices, faces and edges there are, vertices a line each, and faces as lists of vertices.
#include "common/description/formats/mesh_loaders.h"
#include "common/description/formats/mesh_tables.h"
#include "common/description/formats/row_words.h"
#include "common/description/formats/text_pieces.h"
#include "common/files/read_file.h"

namespace rayfarm {
namespace {

/// What the first word says that vertices have beside a position.
struct OffKind {
  bool has_uv = false, has_color = false, has_normal = false;
  bool is_word = false;       ///< there is such a word
  std::string_view behind{};  ///< the word, as where counts follow without a space
};

OffKind kind_of(RowWords& words, std::string_view word) {
  OffKind kind;
  std::string_view rest = word;
  const auto take = [&rest](std::string_view prefix) {
    if (!rest.starts_with(prefix)) return false;
    rest.remove_prefix(prefix.size());
    return true;
  };
  kind.has_uv = take("ST");
  kind.has_color = take("C");
  kind.has_normal = take("N");
  if (rest.starts_with("4OFF") || rest.starts_with("nOFF") || rest.starts_with("4nOFF"))
    words.fail(fmt::format("'{}' has vertices of other than three coordinates; only three are read",
                           word.substr(0, 40)));
  kind.is_word = take("OFF");
  if (!kind.is_word) return {};
  kind.behind = rest;
  return kind;
}

class OffReader {
 public:
  OffReader(std::string_view text, const std::string& path) : path_(path), words_(text, path, 0) {}

  MeshTables read() {
    if (!words_.next_row()) words_.fail("the file is empty");
    OffKind kind = kind_of(words_, words_.peek());
    if (kind.is_word)
      words_.word();
    else if (!std::isdigit(static_cast<unsigned char>(words_.peek().front())))
      words_.fail(fmt::format("an OFF file begins with OFF, or a word like STCNOFF, not with '{}'",
                              words_.peek().substr(0, 40)));
    if (words_.peek() == "BINARY")
      words_.fail("the file is in OFF's binary form, which is not read; save it as text, or as PLY");
    uint64_t vertices = 0;
    if (kind.behind.empty()) {
      if (!words_.has_more() && !words_.next_row())
        words_.fail("the file ends before it tells of its vertices");
      vertices = count();
    } else {
      RowWords behind(kind.behind, path_, words_.line() - 1);
      behind.next_row();
      vertices = count_in(behind);
    }
    const uint64_t faces = count();
    while (words_.has_more()) words_.word();  // edges, which nobody counts rightly
    MeshTable vertex, face;
    vertex.name = "vertex";
    vertex.use = TableUse::vertices;
    vertex.rows = vertices;
    add_columns(vertex, kind);
    face.name = "face";
    face.use = TableUse::faces;
    face.rows = faces;
    face.rest = "the colour";
    face.columns.push_back({NumberType::int32, NumberType::int32, ColumnRole::corners});
    tables_.tables = {std::move(vertex), std::move(face)};
    return std::move(tables_);
  }

 private:
  uint64_t count() { return count_in(words_); }
  static uint64_t count_in(RowWords& words) {
    const int64_t n = words.whole();
    if (n < 0 || n > UINT32_MAX - 1) words.fail(fmt::format("there can't be {} vertices or faces", n));
    return static_cast<uint64_t>(n);
  }

  void add_columns(MeshTable& vertex, const OffKind& kind) {
    const auto add = [&vertex](std::initializer_list<ColumnRole> roles, NumberType type) {
      for (const ColumnRole role : roles) vertex.columns.push_back({type, std::nullopt, role});
    };
    const int lines = words_.line();
    tables_.body = words_.behind_row();
    tables_.lines_before = lines;
    add({ColumnRole::x, ColumnRole::y, ColumnRole::z}, NumberType::float32);
    if (kind.has_normal)
      add({ColumnRole::normal_x, ColumnRole::normal_y, ColumnRole::normal_z}, NumberType::float32);
    if (kind.has_color && vertex.rows > 0) {
      const Colors colors = look_at_colors(3 + 3 * kind.has_normal, 2 * kind.has_uv, vertex.rows);
      add({ColumnRole::red, ColumnRole::green, ColumnRole::blue}, colors.type);
      if (colors.has_alpha) add({ColumnRole::alpha}, colors.type);
    }
    if (kind.has_uv) add({ColumnRole::u, ColumnRole::v}, NumberType::float32);
  }

  struct Colors {
    NumberType type = NumberType::float32;
    bool has_alpha = false;
  };
  /// Colours are three numbers or four, up to 255 or up to 1: the first vertices show which.
  Colors look_at_colors(size_t words_before, size_t words_behind, uint64_t vertices) const {
    constexpr uint64_t kVertices = 1000;
    RowWords words(tables_.body, path_, tables_.lines_before);
    Colors colors;
    for (uint64_t i = 0; i < std::min(vertices, kVertices) && words.next_row(); ++i) {
      std::array<std::string_view, 13> row;  // a longer one has more than vertices have
      size_t count = 0;
      while (count < row.size() && words.has_more()) row[count++] = words.word();
      if (i == 0) colors.has_alpha = count > words_before + 3 + words_behind;
      for (size_t k = words_before; k < std::min(count, words_before + 3); ++k) {
        if (row[k].find_first_of(".eE") != std::string_view::npos)
          return {NumberType::float32, colors.has_alpha};
        if (row[k] != "0" && row[k] != "1") colors.type = NumberType::uint8;
      }
    }
    return colors;
  }

  const std::string& path_;
  RowWords words_;
  MeshTables tables_;
};

}  // namespace

void load_off_mesh(SceneDescription& scene, uint32_t object, const MeshRequest& request,
                   const LoadOptions& options) {
  const FileText file = read_large_text_file(request.path, limits::kFileBytes, options.stop);
  scene.files.push_back(request.path);
  const MeshTables tables = OffReader(file.text(), request.path).read();
  scene.objects[object].primitives.push_back(
      {read_mesh_tables(scene, tables, request, borders_of_pieces(tables.body.size()), options),
       request.material, request.place});
}

}  // namespace rayfarm
