#include "host/experiments/hierarchies/thesis_tables.h"

#include <algorithm>
#include <stdexcept>

namespace rayfarm {
namespace {

constexpr auto R = Scheme::regular, A = Scheme::adaptive, V = Scheme::object_volume;

constexpr std::array kSizes{SizeRow{R, 1, 25, 10820, 1347, 0, 0, 0, 13836, 104012, false},
                            SizeRow{R, 1, 15, 13623, 2000, 0, 0, 0, 25000, 162492, true},
                            SizeRow{R, 1, 10, 16683, 3000, 0, 0, 0, 50000, 278732, true},
                            SizeRow{R, 2, 25, 146, 197, 0, 0, 0, 269, 2448, false},
                            SizeRow{R, 2, 15, 234, 278, 0, 0, 0, 350, 3448, false},
                            SizeRow{R, 2, 10, 356, 373, 0, 0, 0, 445, 4696, false},
                            SizeRow{R, 3, 25, 1794, 1581, 0, 0, 0, 17388, 83052, false},
                            SizeRow{R, 3, 15, 1794, 1581, 0, 0, 0, 17388, 83052, false},
                            SizeRow{R, 3, 10, 2456, 2457, 0, 0, 0, 300000, 1219652, true},
                            SizeRow{A, 1, 25, 0, 0, 1327, 0, 0, 11345, 81228, false},
                            SizeRow{A, 1, 15, 0, 0, 2600, 0, 0, 20000, 146400, true},
                            SizeRow{A, 1, 10, 0, 0, 5200, 0, 0, 35000, 268800, true},
                            SizeRow{A, 2, 25, 0, 0, 37, 0, 0, 141, 5452, false},
                            SizeRow{A, 2, 15, 0, 0, 62, 0, 0, 196, 6272, false},
                            SizeRow{A, 2, 10, 0, 0, 114, 0, 0, 258, 7768, false},
                            SizeRow{A, 3, 25, 0, 0, 824, 0, 0, 8021, 55860, false},
                            SizeRow{A, 3, 15, 0, 0, 1776, 0, 0, 11681, 93348, false},
                            SizeRow{A, 3, 10, 0, 0, 3100, 0, 0, 20000, 158400, true},
                            SizeRow{V, 1, 25, 0, 0, 0, 53, 278, 3067, 20420, false},
                            SizeRow{V, 1, 15, 0, 0, 0, 146, 753, 4816, 39148, false},
                            SizeRow{V, 1, 10, 0, 0, 0, 296, 1569, 6948, 67596, false},
                            SizeRow{V, 2, 25, 0, 0, 0, 0, 1, 58, 2012, false},
                            SizeRow{V, 2, 15, 0, 0, 0, 0, 1, 58, 2012, false},
                            SizeRow{V, 2, 10, 0, 0, 0, 0, 1, 58, 2012, false},
                            SizeRow{V, 3, 25, 0, 0, 0, 188, 1110, 8994, 63832, false},
                            SizeRow{V, 3, 15, 0, 0, 0, 497, 2803, 14017, 125200, false},
                            SizeRow{V, 3, 10, 0, 0, 0, 953, 5656, 21677, 223844, false}};

// Adaptive 2/10's construction is printed 167.5 s, regular 3/10's size 1.2M.
constexpr std::array kTimes{
    TimeRow{R, 1, 25, 10.4, 314, 96.2, 93.1, false},   TimeRow{R, 1, 15, 11.0, 265, 81.4, 160, true},
    TimeRow{R, 1, 10, 13.0, 200, 61.9, 275, true},     TimeRow{R, 2, 25, 4.18, 42.1, 13.2, .91, false},
    TimeRow{R, 2, 15, 5.33, 39.6, 12.5, 1.46, false},  TimeRow{R, 2, 10, 6.17, 36.7, 11.7, 2.71, false},
    TimeRow{R, 3, 25, 4.39, 32.3, 10.2, 71.2, false},  TimeRow{R, 3, 15, 5.17, 29.6, 9.49, 98.7, false},
    TimeRow{R, 3, 10, 6.75, 27.0, 8.86, 160, true},    TimeRow{A, 1, 25, 42.1, 296, 98.8, 86.7, false},
    TimeRow{A, 1, 15, 60, 250, 88.8, 150, true},       TimeRow{A, 1, 10, 80, 180, 71.9, 250, true},
    TimeRow{A, 2, 25, 2.84, 39.4, 12.6, .85, false},   TimeRow{A, 2, 15, 4.27, 37.4, 12.3, 1.27, false},
    TimeRow{A, 2, 10, 6.91, 31.6, 10.9, 1.675, false}, TimeRow{A, 3, 25, 40.7, 20.1, 14.9, 58.72, false},
    TimeRow{A, 3, 15, 49.8, 18.8, 16.5, 93.8, false},  TimeRow{A, 3, 10, 60, 17, 18.2, 140, true},
    TimeRow{V, 1, 25, 24.7, 54.0, 25.4, 18.6, false},  TimeRow{V, 1, 15, 36.9, 43.2, 24.8, 32.8, false},
    TimeRow{V, 1, 10, 55.1, 33.6, 26.4, 47.7, false},  TimeRow{V, 2, 25, 1, 4.92, 4.80, .29, false},
    TimeRow{V, 2, 15, 1, 4.92, 4.80, .29, false},      TimeRow{V, 2, 10, 1, 4.92, 4.80, .29, false},
    TimeRow{V, 3, 25, 43.2, 19.8, 19.2, 58.5, false},  TimeRow{V, 3, 15, 54.5, 17.1, 21.1, 86.1, false},
    TimeRow{V, 3, 10, 67.1, 15.0, 24.2, 120.4, false}};

constexpr std::array kObjects{ObjectRow{1, 17.97, 260, 81.5, 15, 14, 1376, 2.4},
                              ObjectRow{2, 20.0, 4.92, 4.55, 20, 19, 1836, 3.2},
                              ObjectRow{3, 16.9, 712, 218, 13, 12, 1192, 2.1}};

constexpr std::array kImages{ImageRow{1658, 208436, 1256, 970, 504, 247584, 654404, 73281},
                             ImageRow{66, 8884, 448, 906, 619, 10896, 417716, 66332},
                             ImageRow{2708, 286128, 1293, 1091, 794, 411328, 818148, 101918}};

// "misc" and what is not called have no calls. The calls of mknod for Image 3 are printed 1465596: 30 s of
// .00021 ask for six digits.
constexpr std::array kRoutines{RoutineRow{"ptrace", {783868, 254802, 578364}, {1256, 131, 1293}},
                               RoutineRow{"qtrace", {0, 272242, 0}, {0, 252, 0}},
                               RoutineRow{"otrace", {2410506, 4166057, 2876956}, {430, 632, 467}},
                               RoutineRow{"vtrace", {1542403, 534051, 2139110}, {296, 122, 467}},
                               RoutineRow{"ndmult", {1719298, 1068102, 1225832}, {244, 152, 175}},
                               RoutineRow{"sqr", {277821, 738251, 344267}, {66, 175, 82}},
                               RoutineRow{"render", {1, 1, 1}, {41, 41, 41}},
                               RoutineRow{"wpixel", {66049, 66049, 66049}, {41, 41, 41}},
                               RoutineRow{"teval", {66247, 105615, 90413}, {40, 65, 47}},
                               RoutineRow{"shade", {66247, 105615, 90413}, {35, 67, 55}},
                               RoutineRow{"mknod", {95655, 114553, 1465596}, {19, 26, 30}},
                               RoutineRow{"readd", {1, 19, 1}, {2, .1, 5}},
                               RoutineRow{"mmult", {47, 83, 132}, {.12, .18, .31}},
                               RoutineRow{"spixel", {1, 1, 1}, {1, 1, 1}},
                               RoutineRow{"misc", {0, 0, 0}, {260, 267, 480}}};

template <typename Rows>
const auto& find_row(const Rows& rows, Scheme scheme, int image, int cut) {
  const auto row = std::find_if(rows.begin(), rows.end(), [&](const auto& r) {
    return r.scheme == scheme && r.image == image && r.cut == cut;
  });
  if (row == rows.end()) throw std::logic_error("the thesis has no such row");
  return *row;
}

constexpr double kLink_ms = .153, kTest_ms = .303;
constexpr std::array<double, 3> kStep_ms{.102, .216, .245};

}  // namespace

const SizeRow& size_row(Scheme scheme, int image, int cut) {
  return find_row(kSizes, scheme, image, cut);
}

const TimeRow& time_row(Scheme scheme, int image, int cut) {
  return find_row(kTimes, scheme, image, cut);
}

std::span<const ObjectRow> object_rows() {
  return kObjects;
}

std::span<const ImageRow> image_rows() {
  return kImages;
}

std::span<const RoutineRow> routine_rows() {
  return kRoutines;
}

double bytes_by_formula(const SizeRow& row, double object_nodes) {
  const double hash_bytes = row.scheme == Scheme::adaptive ? 4000 : 0;
  return 88 * object_nodes + 24 * (row.nodes + row.interior) + 20 * row.leaves +
         4 * (row.empty + row.full + row.pointers) + hash_bytes;
}

double object_vax_ms(double nodes_visited, double primitives) {
  return nodes_visited * kLink_ms + primitives * kTest_ms;
}

double overhead_vax_ms(Scheme scheme, double nodes_visited) {
  switch (scheme) {
    case Scheme::regular:
      return 0;
    case Scheme::adaptive:
      return .05;
    case Scheme::object_volume:
      break;
  }
  return kLink_ms * nodes_visited;
}

double vax_ms(Scheme scheme, double volumes, double primitives, double nodes_visited) {
  return volumes * kStep_ms[static_cast<size_t>(scheme)] + primitives * kTest_ms +
         overhead_vax_ms(scheme, nodes_visited);
}

}  // namespace rayfarm
