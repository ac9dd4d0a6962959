#pragma once
// Chapter 4 of the thesis in numbers: Tables 4.5 to 4.8, as its formulas prove them, and Equations 4.4 and
// 4.5 with its unit times. Milliseconds are a VAX 11/780's.
#include <array>
#include <span>
#include <string>

namespace rayfarm {

/// The thesis's volume hierarchies.
enum class Scheme { regular, adaptive, object_volume };
/// Rows that stand for them here: `regular`, `adaptive`, and `thesis` to the letter, with spheres and always
/// clipped, below each object.
inline constexpr std::array kSchemeNames{"regular", "adaptive", "object/volume"};

inline constexpr std::array<int, 3> kThesisCuts{25, 15, 10};

/// Table 4.5. What a scheme has no nodes of is 0.
struct SizeRow {
  Scheme scheme;
  int image, cut;
  double empty, full;  ///< cells of regular
  double nodes;        ///< of the adaptive tree
  double interior, leaves;
  double pointers;
  double bytes;      ///< as printed
  bool is_estimate;  ///< the thesis's

  double children_per_interior() const { return (interior + leaves - 1) / interior; }
};

/// Tables 4.6 and 4.7.
struct TimeRow {
  Scheme scheme;
  int image, cut;
  double volumes, primitives;  ///< N_V and N_P, per ray
  double ray_ms;               ///< as printed
  double build_s;
  bool is_estimate;
};

/// Table 4.7's first part, N_P of Image 1 as the total demands; and Tables 4.5 and 4.6 of the objects.
struct ObjectRow {
  int image;
  double nodes_visited, primitives;  ///< N_O and N_P, per ray
  double ray_ms;
  double nodes, pointers, bytes;
  double update_ms;  ///< of objects between two frames
};

/// Of image `image`, 1 to 3.
struct ImageRow {
  double primitives;                            ///< Table 4.10, initial
  double image_bytes;                           ///< Table 4.4
  double intersection_s, traversal_s, other_s;  ///< Table 4.10
  double storage_bytes;                         ///< Table 4.11
  double total_bytes, active_bytes;             ///< Table 4.12
};

const SizeRow& size_row(Scheme scheme, int image, int cut);
const TimeRow& time_row(Scheme scheme, int image, int cut);
std::span<const ObjectRow> object_rows();
std::span<const ImageRow> image_rows();

/// Table 4.8: calls and seconds by image. Columns sum to 2731, 1972 and 3184 s.
struct RoutineRow {
  const char* name;
  std::array<double, 3> calls, seconds;
};
std::span<const RoutineRow> routine_rows();

/// Code, "data overhead" and raster (Table 4.11).
inline constexpr std::array<double, 3> kProgramBytes{194416, 15796, 196608};

/// The formulas behind Table 4.5 (4.3.2): an object node takes 88 bytes, an adaptive one 24, an interior
/// volume 24, a leaf 20, a cell and a pointer 4, the hash table 4,000.
double bytes_by_formula(const SizeRow& row, double object_nodes);

/// Equation 4.4: N_O (T_B + T_L) + N_P · T_P, of a ray, with T_B + T_L = .153 and T_P = .303 ms.
double object_vax_ms(double nodes_visited, double primitives);
/// T_O: 0, .05, and of object/volume the time of its object part, .153 · N_O.
double overhead_vax_ms(Scheme scheme, double nodes_visited);
/// Equation 4.5: N_V · T_N + N_P · T_P + T_O, with T_N = .102, .216 and .245 ms.
double vax_ms(Scheme scheme, double volumes, double primitives, double nodes_visited);

}  // namespace rayfarm
