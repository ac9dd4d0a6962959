#include "common/description/formats/ply_header.h"

#include <charconv>

namespace rayfarm {
namespace {

constexpr size_t kMostNames = 1000;  ///< of elements, and of an element's properties
constexpr size_t kLongestLine = 1 << 16;

struct TypeName {
  std::string_view name;
  NumberType type;
};
constexpr TypeName kTypes[] = {
    {"char", NumberType::int8},      {"int8", NumberType::int8},       {"uchar", NumberType::uint8},
    {"uint8", NumberType::uint8},    {"short", NumberType::int16},     {"int16", NumberType::int16},
    {"ushort", NumberType::uint16},  {"uint16", NumberType::uint16},   {"int", NumberType::int32},
    {"int32", NumberType::int32},    {"uint", NumberType::uint32},     {"uint32", NumberType::uint32},
    {"float", NumberType::float32},  {"float32", NumberType::float32}, {"double", NumberType::float64},
    {"float64", NumberType::float64}};

struct RoleName {
  std::string_view name;
  ColumnRole role;
};
/// What programs call the properties of vertices.
constexpr RoleName kVertexRoleNames[] = {{"x", ColumnRole::x},
                                         {"y", ColumnRole::y},
                                         {"z", ColumnRole::z},
                                         {"nx", ColumnRole::normal_x},
                                         {"ny", ColumnRole::normal_y},
                                         {"nz", ColumnRole::normal_z},
                                         {"normal_x", ColumnRole::normal_x},
                                         {"normal_y", ColumnRole::normal_y},
                                         {"normal_z", ColumnRole::normal_z},
                                         {"u", ColumnRole::u},
                                         {"v", ColumnRole::v},
                                         {"s", ColumnRole::u},
                                         {"t", ColumnRole::v},
                                         {"texture_u", ColumnRole::u},
                                         {"texture_v", ColumnRole::v},
                                         {"texture_s", ColumnRole::u},
                                         {"texture_t", ColumnRole::v},
                                         {"red", ColumnRole::red},
                                         {"green", ColumnRole::green},
                                         {"blue", ColumnRole::blue},
                                         {"alpha", ColumnRole::alpha},
                                         {"r", ColumnRole::red},
                                         {"g", ColumnRole::green},
                                         {"b", ColumnRole::blue},
                                         {"a", ColumnRole::alpha},
                                         {"diffuse_red", ColumnRole::red},
                                         {"diffuse_green", ColumnRole::green},
                                         {"diffuse_blue", ColumnRole::blue},
                                         {"diffuse_alpha", ColumnRole::alpha}};
constexpr RoleName kFaceRoleNames[] = {{"vertex_indices", ColumnRole::corners},
                                       {"vertex_index", ColumnRole::corners},
                                       {"texcoord", ColumnRole::corner_uvs}};

class HeaderReader {
 public:
  HeaderReader(SceneDescription& scene, std::string_view bytes, const std::string& path)
      : scene_(scene), bytes_(bytes), path_(path) {}

  MeshTables read() {
    if (!next_line() || word() != "ply") fail("a PLY file begins with a line `ply`");
    while (next_line()) {
      const std::string_view keyword = word();
      if (keyword == "end_header") {
        finish();
        return std::move(tables_);
      }
      if (keyword == "format")
        read_format();
      else if (keyword == "comment" || keyword == "obj_info")
        read_comment();
      else if (keyword == "element")
        read_element();
      else if (keyword == "property")
        read_property();
      else if (!keyword.empty())
        fail(fmt::format(
            "expected format, comment, element, property or end_header, found '{}'{}", keyword.substr(0, 40),
            suggestion(keyword.substr(0, 40), {"format", "comment", "element", "property", "end_header"})));
    }
    fail("the file ends before `end_header`");
  }

 private:
  /// Lines end as the first does: with a carriage return alone the byte behind it may be a number's.
  bool next_line() {
    if (at_ >= bytes_.size()) return false;
    const size_t end = std::min(bytes_.find_first_of("\n\r", at_), bytes_.size());
    row_ = bytes_.substr(at_, end - at_);
    if (line_++ == 0) has_feeds_ = end + 1 >= bytes_.size() || bytes_[end] == '\n' || bytes_[end + 1] == '\n';
    if (row_.size() > kLongestLine) fail("the line is too long for a PLY file's head");
    at_ = end;
    if (has_feeds_) {
      while (at_ < bytes_.size() && bytes_[at_] == '\r') ++at_;
      if (at_ < bytes_.size() && bytes_[at_] != '\n') fail("a carriage return stands within the line");
    }
    at_ = std::min(at_ + 1, bytes_.size());
    return true;
  }
  std::string_view word() {
    const size_t begin = std::min(row_.find_first_not_of(" \t"), row_.size());
    const size_t end = std::min(row_.find_first_of(" \t", begin), row_.size());
    const std::string_view taken = row_.substr(begin, end - begin);
    row_.remove_prefix(end);
    return taken;
  }
  [[noreturn]] void fail(std::string_view problem) const { throw InputError({path_, line_}, problem); }

  void read_format() {
    const std::string_view name = word(), version = word();
    if (name == "ascii")
      tables_.encoding = TableEncoding::text;
    else if (name == "binary_little_endian")
      tables_.encoding = TableEncoding::little_endian;
    else if (name == "binary_big_endian")
      tables_.encoding = TableEncoding::big_endian;
    else
      fail(fmt::format("expected ascii, binary_little_endian or binary_big_endian, found '{}'",
                       name.substr(0, 40)));
    if (version != "1.0") fail(fmt::format("PLY has a version 1.0 only, not '{}'", version.substr(0, 40)));
    has_format_ = true;
  }

  /// MeshLab names the image that belongs to the coordinates in a comment.
  void read_comment() {
    if (word() != "TextureFile") return;
    const size_t begin = std::min(row_.find_first_not_of(" \t"), row_.size());
    scene_.notes.add(
        {path_, line_},
        fmt::format("the image '{}' is not used; give the mesh a material with this texture in a scene",
                    row_.substr(begin, 200)));
  }

  void read_element() {
    finish_element();
    MeshTable& table = tables_.tables.emplace_back();
    table.name = word().substr(0, 100);
    lines_.push_back(line_);
    const std::string_view count = word();
    const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), table.rows);
    if (table.name.empty() || error != std::errc{} || end != count.data() + count.size())
      fail(fmt::format("expected a name and how many there are, found '{} {}'", table.name,
                       count.substr(0, 40)));
    if (tables_.tables.size() > kMostNames) fail("the file tells of too many elements");
    table.use = table.name == "vertex"      ? TableUse::vertices
                : table.name == "face"      ? TableUse::faces
                : table.name == "tristrips" ? TableUse::strips
                                            : TableUse::unused;
    if (table.use == TableUse::vertices && table.rows > UINT32_MAX - 1)
      fail(fmt::format("a mesh has at most {} vertices", UINT32_MAX - 1));
    for (size_t i = 0; i + 1 < tables_.tables.size(); ++i)
      if (tables_.tables[i].name == table.name)
        fail(fmt::format("element '{}' stands here twice", table.name));
    names_.clear();
  }

  NumberType read_type() {
    const std::string_view name = word();
    for (const TypeName& type : kTypes)
      if (type.name == name) return type.type;
    std::vector<std::string> names;
    for (const TypeName& type : kTypes) names.emplace_back(type.name);
    fail(fmt::format("unknown type '{}'{}", name.substr(0, 40), suggestion(name.substr(0, 40), names)));
  }

  void read_property() {
    if (tables_.tables.empty()) fail("a property must stand behind its element");
    MeshTable& table = tables_.tables.back();
    TableColumn column;
    if (std::string_view rest = row_; word() != "list")
      row_ = rest;
    else
      column.count_type = read_type();
    column.type = read_type();
    const std::string name(word().substr(0, 100));
    if (name.empty()) fail("the property has no name");
    if (std::find(names_.begin(), names_.end(), name) != names_.end())
      fail(fmt::format("property '{}' stands here twice", name));
    if (names_.size() >= kMostNames) fail("the element has too many properties");
    column.role = role_of(table, column, name);
    names_.push_back(name);
    table.columns.push_back(column);
  }

  ColumnRole role_of(const MeshTable& table, const TableColumn& column, std::string_view name) const {
    const bool is_of_vertices = table.use == TableUse::vertices;
    if (table.use == TableUse::unused || column.count_type.has_value() == is_of_vertices)
      return ColumnRole::unused;
    const std::span<const RoleName> names = is_of_vertices ? std::span<const RoleName>(kVertexRoleNames)
                                                           : std::span<const RoleName>(kFaceRoleNames);
    for (const RoleName& n : names)
      if (n.name == name && !table.has(n.role) &&
          !(table.use == TableUse::strips && n.role == ColumnRole::corner_uvs))
        return n.role;
    return ColumnRole::unused;
  }

  /// Roles without the others that belong to them are none; what is not used is noted.
  void finish_element() {
    if (tables_.tables.empty()) return;
    MeshTable& table = tables_.tables.back();
    // False if not all of the roles from the first on are there; then there are none of them.
    const auto keep_all = [&table](ColumnRole first, size_t count) {
      const auto is_one = [&](const TableColumn& c) {
        return c.role >= first && static_cast<size_t>(c.role) < static_cast<size_t>(first) + count;
      };
      if (std::count_if(table.columns.begin(), table.columns.end(), is_one) == static_cast<ptrdiff_t>(count))
        return true;
      for (TableColumn& c : table.columns)
        if (is_one(c)) c.role = ColumnRole::unused;
      return false;
    };
    if (table.use == TableUse::vertices) {
      if (!keep_all(ColumnRole::x, 3)) fail_at_element("its vertices lack x, y or z");
      keep_all(ColumnRole::normal_x, 3);
      keep_all(ColumnRole::u, 2);
      if (!keep_all(ColumnRole::red, 3))
        for (TableColumn& c : table.columns)
          if (c.role == ColumnRole::alpha) c.role = ColumnRole::unused;
    } else if (table.use != TableUse::unused && table.rows > 0 && !table.has(ColumnRole::corners)) {
      fail_at_element(fmt::format("element '{}' has no list `vertex_indices`", table.name));
    }
    if (table.rows == 0) return;
    std::string unused;
    for (size_t i = 0; i < table.columns.size(); ++i)
      if (table.use != TableUse::unused && table.columns[i].role == ColumnRole::unused)
        unused += (unused.empty() ? "`" : ", `") + names_[i] + "`";
    const SourcePlace place{path_, lines_.back()};
    if (table.use == TableUse::unused)
      scene_.notes.add(place, fmt::format("element '{}' is not used ({} of it)", table.name, table.rows));
    else if (!unused.empty())
      scene_.notes.add(place, fmt::format("of element '{}' is not used: {}", table.name, unused));
  }
  [[noreturn]] void fail_at_element(const std::string& problem) const {
    throw InputError({path_, lines_.back()}, problem);
  }

  void finish() {
    finish_element();
    if (!has_format_) fail("the head has no line `format`");
    const bool has_vertices = std::any_of(tables_.tables.begin(), tables_.tables.end(),
                                          [](const MeshTable& t) { return t.use == TableUse::vertices; });
    if (!has_vertices) fail("the head has no element 'vertex'");
    tables_.body = bytes_.substr(at_);
    tables_.bytes_before = at_;
    tables_.lines_before = line_;
  }

  SceneDescription& scene_;
  std::string_view bytes_;
  const std::string& path_;
  MeshTables tables_;
  std::vector<int> lines_;          ///< of the elements
  std::vector<std::string> names_;  ///< of the last element's properties
  std::string_view row_;            ///< what is left of the line
  size_t at_ = 0;                   ///< where the next line begins
  int line_ = 0;
  bool has_feeds_ = true, has_format_ = false;
};

}  // namespace

MeshTables read_ply_header(SceneDescription& scene, std::string_view bytes, const std::string& path) {
  return HeaderReader(scene, bytes, path).read();
}

}  // namespace rayfarm
