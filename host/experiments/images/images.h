#pragma once
// The test images of the thesis's chapter 4 (Table 4.3), rebuilt: counts, colours and kinds of objects are
// the table's, places, views, lights and materials ours. And a mesh, for what is larger than the thesis could
// hold.
#include <string>

namespace rayfarm {

/// Image 1, a beach house of 1,658 polygons in 14 objects: a large open room with small complex objects, and
/// a horizon far outside. Image 2 is scenes/primitives.yaml. Image 3, a plant of 2,708 polygons in 12 objects
/// that overlap and leave little empty space. Each writes `path` (.yaml); throws IoError.
void write_beach_house(const std::string& path);
void write_plant(const std::string& path);

/// A hilly terrain of 2 · cells² triangles as `path` (.yaml), its mesh beside it (.obj). Throws IoError.
void write_terrain(const std::string& path, int cells);

}  // namespace rayfarm
