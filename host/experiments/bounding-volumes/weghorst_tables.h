#pragma once
// What Weghorst, Hooper and Greenberg printed in 1984: Tables II to IX ("Improved Computational Methods for
// Ray Tracing", ACM Transactions on Graphics 3, 1).
#include <array>
#include <cstddef>
#include <cstdint>

namespace rayfarm::weghorst {

/// C: bounding spheres, S: selected volumes, H: with the hierarchy of clusters, Z: with the item buffer.
inline constexpr std::array kCombinations{"C", "CZ", "CH", "CHZ", "S", "SZ", "SH", "SHZ"};
inline constexpr size_t kCombinationCount = kCombinations.size();
constexpr bool has_selected(size_t combination) {
  return combination >= 4;
}
constexpr bool has_clusters(size_t combination) {
  return (combination & 2) != 0;
}
constexpr bool has_buffer(size_t combination) {
  return (combination & 1) != 0;
}
/// Places in kCombinations.
inline constexpr size_t kC = 0, kCZ = 1, kCH = 2, kS = 4, kSH = 6, kSHZ = 7;

using Row = std::array<double, kCombinationCount>;

/// An environment, and its table. Phases are in percent of their column's time; a 0 was not printed.
struct Environment {
  const char* table;
  const char* title;
  const char* scene;  ///< in scenes/hierarchies
  int frame;
  uint32_t depth;  ///< of ray trees; 0: adaptive
  double hours;    ///< of C
  Row total;       ///< relative to C
  Row tree, shadow, buffer, colour, miscellaneous;
};

inline constexpr std::array<Environment, 10> kEnvironments{{
    {"II",
     "Pencils I",
     "pencils_1",
     0,
     1,
     6.02,
     {1.00, 0.67, 0.86, 0.54, 0.54, 0.40, 0.32, 0.28},
     {48.4, 14.3, 46.7, 16.5, 43.7, 21.5, 39.8, 30.1},
     {44.8, 75.3, 45.5, 70.7, 43.9, 61.3, 40.2, 46.1},
     {0, 0.3, 0, 0.3, 0, 0.3, 0, 0.7},
     {3.5, 5.2, 4.0, 6.4, 6.4, 8.4, 10.4, 11.5},
     {3.3, 4.9, 3.8, 6.1, 6.0, 8.3, 9.6, 11.6}},
    {"III",
     "Pencils II",
     "pencils_2",
     0,
     3,
     11.94,
     {1.00, 0.79, 0.79, 0.62, 0.76, 0.65, 0.37, 0.34},
     {52.5, 39.9, 53.6, 40.0, 46.6, 40.4, 43.5, 40.0},
     {40.6, 51.0, 37.7, 48.9, 44.0, 48.9, 38.2, 39.8},
     {0, 0.2, 0, 0.2, 0, 0.2, 0, 0.3},
     {5.2, 6.6, 6.5, 8.2, 6.8, 7.8, 13.7, 14.8},
     {1.7, 2.3, 2.2, 2.7, 2.3, 2.7, 4.6, 5.1}},
    {"IV",
     "Pencils III",
     "pencils_3",
     0,
     1,
     17.07,
     {1.00, 0.78, 0.82, 0.66, 0.51, 0.44, 0.28, 0.26},
     {23.7, 4.5, 23.7, 5.3, 22.1, 8.2, 19.9, 13.6},
     {70.8, 88.5, 69.9, 86.5, 67.6, 79.6, 62.3, 66.4},
     {0, 0.1, 0, 0.1, 0, 0.2, 0, 0.3},
     {4.0, 5.0, 4.7, 5.9, 7.5, 8.7, 13.0, 14.3},
     {1.5, 1.9, 1.7, 2.2, 2.8, 3.3, 4.8, 5.4}},
    {"VI",
     "Camera",
     "camera",
     0,
     0,
     6.61,
     {1.00, 0.92, 0.90, 0.80, 0.67, 0.60, 0.53, 0.49},
     {60.9, 56.0, 60.6, 56.4, 57.3, 51.9, 56.1, 52.5},
     {30.6, 34.6, 30.0, 33.0, 30.1, 33.7, 28.1, 30.2},
     {0, 0.2, 0, 0.2, 0, 0.3, 0, 0.3},
     {3.0, 3.2, 3.3, 3.7, 4.4, 4.9, 5.5, 5.9},
     {5.5, 6.0, 6.1, 6.7, 8.2, 9.2, 10.3, 11.1}},
    {"VII",
     "Office",
     "office",
     0,
     0,
     14.6,
     {1.00, 0.87, 0.74, 0.67, 0.90, 0.79, 0.56, 0.49},
     {21.5, 9.6, 21.8, 10.5, 21.3, 10.4, 22.3, 12.3},
     {74.1, 85.0, 72.3, 82.9, 73.8, 83.8, 70.2, 78.9},
     {0, 0.2, 0, 0.2, 0, 0.2, 0, 0.3},
     {3.4, 3.9, 4.6, 4.9, 3.8, 4.3, 5.8, 6.5},
     {1.0, 1.4, 1.3, 1.5, 1.1, 1.3, 1.7, 2.0}},
    {"VIII",
     "Pool Room",
     "pool_room",
     0,
     0,
     14.33,
     {1.00, 0.84, 0.87, 0.74, 0.65, 0.60, 0.45, 0.41},
     {21.7, 10.3, 21.5, 10.6, 22.5, 14.0, 21.8, 15.8},
     {75.2, 86.1, 74.9, 85.3, 72.9, 81.0, 71.3, 76.8},
     {0, 0.1, 0, 0.1, 0, 0.1, 0, 0.2},
     {2.2, 2.6, 2.5, 2.9, 3.4, 3.5, 5.0, 5.3},
     {0.9, 0.9, 1.1, 1.1, 1.2, 1.4, 1.9, 1.9}},
    {"V, A",
     "Polygons, view A",
     "polygons",
     1,
     0,
     1.57,
     {1, 0, 0, 0, 0, 0, 0, 0.82},
     {46.5, 0, 0, 0, 0, 0, 0, 36.2},
     {42.2, 0, 0, 0, 0, 0, 0, 49.0},
     {0, 0, 0, 0, 0, 0, 0, 1.0},
     {5.2, 0, 0, 0, 0, 0, 0, 6.4},
     {6.1, 0, 0, 0, 0, 0, 0, 7.4}},
    {"V, B",
     "Polygons, view B",
     "polygons",
     2,
     0,
     3.12,
     {1, 0, 0, 0, 0, 0, 0, 0.86},
     {45.4, 0, 0, 0, 0, 0, 0, 38.3},
     {45.9, 0, 0, 0, 0, 0, 0, 51.1},
     {0, 0, 0, 0, 0, 0, 0, 0.6},
     {5.5, 0, 0, 0, 0, 0, 0, 6.2},
     {3.2, 0, 0, 0, 0, 0, 0, 3.8}},
    {"V, C",
     "Polygons, view C",
     "polygons",
     3,
     0,
     0.24,
     {1, 0, 0, 0, 0, 0, 0, 0.66},
     {52.0, 0, 0, 0, 0, 0, 0, 22.0},
     {2.8, 0, 0, 0, 0, 0, 0, 3.9},
     {0, 0, 0, 0, 0, 0, 0, 5.0},
     {9.7, 0, 0, 0, 0, 0, 0, 13.8},
     {35.5, 0, 0, 0, 0, 0, 0, 55.3}},
    {"V, D",
     "Polygons, view D",
     "polygons",
     4,
     0,
     0.89,
     {1, 0, 0, 0, 0, 0, 0, 0.86},
     {43.9, 0, 0, 0, 0, 0, 0, 35.0},
     {39.4, 0, 0, 0, 0, 0, 0, 44.2},
     {0, 0, 0, 0, 0, 0, 0, 1.4},
     {6.1, 0, 0, 0, 0, 0, 0, 7.0},
     {10.6, 0, 0, 0, 0, 0, 0, 12.4}},
}};
/// The environments of Table IX come first; the others are Table V's, of which C and SHZ alone were printed.
inline constexpr size_t kTableNine = 6;

}  // namespace rayfarm::weghorst
