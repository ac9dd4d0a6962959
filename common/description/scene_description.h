#pragma once
// A scene as its author wrote it: names, units and a tree of objects, with the place of everything in its
// file. Loaders fill it; `compile` turns it into the flat arrays that nodes trace.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "common/description/load_options.h"
#include "common/errors/notes.h"
#include "common/errors/stop.h"
#include "common/materials/material.h"
#include "common/memory/large_vector.h"
#include "common/scene/animation.h"
#include "common/scene/build_options.h"
#include "common/scene/goniometry.h"
#include "common/scene/light.h"
#include "common/scene/participating_medium.h"
#include "common/scene/scene_block.h"
#include "common/scene/spectral_color.h"
#include "common/shapes/bilinear_patch.h"
#include "common/shapes/polygon.h"
#include "common/textures/texture.h"

namespace rayfarm {

/// Bounds on what a scene may ask for, so that hostile or damaged input ends in an error.
namespace limits {
inline constexpr uintmax_t kFileBytes = 4ull << 30;  ///< OBJ and NFF
inline constexpr uintmax_t kYamlFileBytes = 256ull << 20;
inline constexpr size_t kNestingDepth = 64;  ///< objects inside objects in YAML
inline constexpr size_t kObjectDepth =
    1000;  ///< in all formats: the tree is walked by functions that call themselves
inline constexpr size_t kObjects = 1'000'000;
inline constexpr size_t kPrimitives = 400'000'000;
inline constexpr size_t kSolidFaces = 250'000;  ///< of a lathe
inline constexpr size_t kBezierTriangles = 50'000'000;
inline constexpr size_t kFaceCorners = 2'000'000'000;  ///< of meshes
inline constexpr size_t kPolygonPoints = 1'000'000;
inline constexpr size_t kQuadricPlanes = 16;
inline constexpr size_t kInstances = 4'000'000;  ///< the object tree, expanded
inline constexpr size_t kLights = 10'000;        ///< the list's, and the objects', expanded
inline constexpr size_t kLuminaires = 100'000;   ///< luminous primitives, expanded
inline constexpr size_t kKeys = 1'000'000;
inline constexpr size_t kBones = 1'000'000;             ///< of all skeletons
inline constexpr size_t kInfluences = 400'000'000;      ///< of joints on vertices, of all skins
inline constexpr size_t kMorphDeltas = 100'000'000;     ///< of all targets
inline constexpr size_t kSpectrumNodes = 10'000;        ///< of one spectrum
inline constexpr uint64_t kTexturePixels = 1ull << 28;  ///< of one image, 16384²: 2 GiB with its mip map
inline constexpr uint64_t kArrayCells = 1ull << 26;     ///< of one array, 406³: 0.5 GiB with its mip map
inline constexpr uint64_t kTexels = 1ull << 30;       ///< of all images and arrays with their mip maps: 6 GiB
inline constexpr uint64_t kMediumCells = 1ull << 27;  ///< of the grids of all media, 512³: 0.5 GiB
inline constexpr double kCoordinate = 1e15;
}  // namespace limits

/// A compact place: an index into `SceneDescription::files`, line and column from 1 (0: unknown).
struct Place {
  uint32_t file = 0;
  int line = 0;
  int column = 0;
};

/// A colour that is given as a spectrum.
struct SpectrumDescription {
  SpectralField field = SpectralField::color;
  uint32_t index = 0;  ///< of the light or medium
  std::vector<SpectrumNode> nodes;
};

/// Classical: I = color (ambient Ia + diffuse sum S I cos) + specular sum S I cos^shininess + reflect R +
/// transmit T (Equations 2.4 and 2.12, with a colour for the diffuse terms).
struct MaterialDescription : Material {
  MaterialDescription() = default;
  explicit MaterialDescription(std::string of_name) : name(std::move(of_name)) {}
  std::string name;
  std::vector<SpectrumDescription> spectra;  ///< of its own colours
};

struct TextureDescription : Texture {
  std::string name;
  std::vector<uint16_t> texels;  ///< of an image or array
  bool is_from_srgb = false;     ///< of an image: its file's numbers were decoded
  std::string origin{};          ///< of an image that MTL files share: its file and how it is read
};

struct DiagramDescription : GoniometricDiagram {
  std::vector<double> values;
};

struct MediumDescription : ParticipatingMedium {
  LargeVector<float> densities;  ///< of its grid
  Place place;
};

/// The thesis's five parameters (2.3.2): location, direction, up, field of view, aspect ratio.
struct ViewDescription {
  Curve location = constant_curve(Vec4(0, 0, 5, 0));
  Curve direction = constant_curve(Vec4(0, 0, -1, 0));
  std::optional<Curve> look_at;  ///< replaces the direction
  Curve up = constant_curve(Vec4(0, 1, 0, 0));
  Curve field_of_view = constant_curve(Vec4(45, 0, 0, 0));  ///< degrees across the image's width
  Curve focus = constant_curve(Vec4(1, 0, 0, 0));           ///< distance at which a lens is sharp
  double lens_radius = 0;                                   ///< 0: a pinhole, all is sharp
  Projection projection = Projection::perspective;
  Curve width = constant_curve(Vec4(1, 0, 0, 0));  ///< of an orthographic view, in the world
  std::array<double, 2> shift{0, 0};               ///< right and up, in widths of the view
  double near = 0, far = std::numeric_limits<double>::infinity();
  double aspect = 4.0 / 3.0;  ///< width / height
  std::optional<std::array<int, 2>> resolution_px;

  /// Width and height of pictures for which nobody asks another size.
  std::array<int, 2> size_px() const {
    return resolution_px.value_or(
        std::array{640, std::clamp(static_cast<int>(std::lround(640 / aspect)), 1, 65536)});
  }
};

struct SphereShape {
  Vec3 center{0};
  double radius = 1;
};
/// An open-ended cone or cylinder.
struct ConeShape {
  Vec3 base{0}, apex{0, 1, 0};
  double base_radius = 1, apex_radius = 1;
};
/// a x² + b y² + c z² + 2d xy + 2e xz + 2f yz + 2g x + 2h y + 2i z + j = 0, kept where every plane has n·p <=
/// d.
struct QuadricShape {
  std::array<double, 10> coefficients{};
  std::vector<Vec4> planes;  ///< (n, d)
};
/// A bilinear patch whose corners do not lie in a plane.
struct PatchShape {
  PatchCorners corners{};
};
struct PolygonShape {
  std::vector<Vec3> points;   ///< coplanar; counter-clockwise seen from the front
  std::vector<Vec3> normals;  ///< empty, or one per point
  Smoothing smoothing = Smoothing::phong;
};
/// A mesh's polygons of more than three corners, one after the other: counter-clockwise seen from outside.
struct MeshPolygons {
  LargeVector<uint32_t> sides;      ///< of each polygon
  LargeVector<uint32_t> corners;    ///< of all: indices into positions
  LargeVector<uint32_t> normals;    ///< empty, or one per corner: indices into normals, ~0 for none
  LargeVector<uint32_t> uvs;        ///< empty, or one per corner: indices into uvs
  LargeVector<uint32_t> materials;  ///< empty, or one per polygon
};
/// How a mesh changes its shape from frame to frame: first its morph targets, then its skin, as in glTF 2.0.
struct DeformationDescription {
  /// A bone of the skeleton as the skin knows it.
  struct Joint {
    uint32_t bone = 0;
    Affine bone_from_mesh;  ///< at rest: the inverse bind matrix
  };
  /// What a target adds to one vertex, times the target's weight. Vertices that don't move need none.
  struct Delta {
    uint32_t vertex = 0;
    glm::vec3 position{0}, normal{0};
  };
  struct Target {
    Curve weight;  ///< in x
    LargeVector<Delta> deltas;
  };

  uint32_t skeleton = kNone;  ///< of SceneDescription::skeletons; kNone: the mesh has no skin
  std::vector<Joint> joints;
  uint32_t influences = 0;         ///< of each vertex: how many of the next two there are
  LargeVector<uint32_t> joint_of;  ///< vertices × influences: indices into joints
  LargeVector<float> weights;      ///< vertices × influences: 0 or more; their sum is made 1
  std::vector<Target> targets;
};

/// A name that a mesh's file has for some of its faces.
struct NamedFaces {
  std::string name;
  size_t faces = 0;
};
/// Polygons over shared vertices. Positions are float, as stored in the scene block.
struct MeshShape {
  LargeVector<glm::vec3> positions, normals;
  MeshPolygons polygons;
  LargeVector<glm::uvec3> triangles;  ///< indices into positions
  /// Empty, or one per triangle: indices into normals, ~0 for none.
  LargeVector<glm::uvec3> triangle_normals;
  LargeVector<uint32_t> materials;  ///< empty, or one per triangle
  LargeVector<glm::vec2> uvs;
  LargeVector<glm::uvec3> triangle_uvs;  ///< empty, or one per triangle: indices into uvs
  LargeVector<glm::vec2> second_uvs;     ///< empty, or one per position; polygons have none
  LargeVector<VertexColor> colors;       ///< empty, or one per position
  std::vector<NamedFaces> names;         ///< of objects and groups of its file, in their order
  Smoothing smoothing = Smoothing::flat;
  /// Null: its shape never changes. Else the mesh has triangles only; its normals are none, or one per
  /// position, and triangles then have those of their corners. A mesh with a skin stands in its skeleton's
  /// space. Objects with such a mesh have no primitives of other kinds.
  std::shared_ptr<const DeformationDescription> deformation;
};
using Shape = std::variant<SphereShape, ConeShape, QuadricShape, PatchShape, PolygonShape, MeshShape>;

struct PrimitiveDescription {
  Shape shape;
  uint32_t material = 0;
  Place place;
};

struct ChildDescription {
  uint32_t object = 0;
  std::vector<TransformStep> transform;  ///< the first step is applied first
  Place place;
  std::optional<Curve> visible{};  ///< 0 in frames that are without the child; none: it is always there
};

/// A tree of spaces that skins hang on. It is apart from the tree of objects, as a mesh with a skin does not
/// move with the object that it is in but with the bones alone: the skeleton's space is that object's.
struct SkeletonDescription {
  struct Bone {
    uint32_t parent = kNone;               ///< stands before it; kNone: the skeleton's space
    std::vector<TransformStep> transform;  ///< the first step is applied first
  };
  std::vector<Bone> bones;
  Place place;
};

/// A light in an object's space.
struct LightDescription {
  Light light;
  Place place;
  std::vector<SpectrumDescription> spectra{};
};

/// Objects from a file of their own, whose volumes are built already (thesis 4.2.2: "objects from a
/// library").
struct LibraryDescription {
  std::string path;
  std::shared_ptr<const SceneBlock> block;  ///< what `scene` looks at
  Scene scene;
  /// Where its materials, textures and diagrams stand among the description's.
  uint32_t first_material = 0, first_texture = 0, first_diagram = 0;
  uint32_t root = 0;  ///< the object that all of it is
};

/// Primitives that are no longer described: a part of a library.
struct BuiltPart {
  uint32_t library = 0;
  uint32_t part = 0;
};

/// How the primitives of an object are arranged, with those of all that is in it and does not move in it.
struct StructureDescription {
  BuildOptions build;
  Place place;
};

/// A node of the object tree. An object may be the child of several others, but never of itself.
struct ObjectDescription {
  std::string name;
  std::vector<PrimitiveDescription> primitives;
  std::vector<ChildDescription> children;
  Place place;
  std::vector<LightDescription> lights{};
  std::optional<BuiltPart> built{};  ///< beside or in place of primitives
  uint32_t structure = kNone;        ///< of SceneDescription::structures; kNone: as what it is in
  std::vector<BoundChoice> bound{};  ///< its volumes, in the order of their tests; empty: as asked for
  Place bound_place{};
};

/// The clip that the user asks for, by name or number: one of the scene's glTF files must have it.
struct ClipSearch {
  bool is_found = false;
  std::vector<std::string> missing;  ///< what would be said of each file that has none of that name
  /// Throws InputError if files were asked and none has it.
  void check() const;
};

/// A clip of a glTF file, as `--clip` may ask for it.
struct ClipDescription {
  std::string file;
  size_t number = 0;
  std::string name;              ///< empty if it has none
  std::optional<double> last_s;  ///< the time of its last key, where the file tells
  bool is_played = false;
};

/// A camera of a glTF file, as `--camera` may ask for it.
struct CameraDescription {
  std::string file;
  size_t number = 0;
  std::string name;
  bool is_view = false;
};

/// An option of `rayfarm render` that a scene asks for, as the command line has it.
struct RenderChoice {
  std::string name;   ///< without dashes in front
  std::string value;  ///< true: of one that takes none
  Place place;
};

struct SceneDescription {
  std::vector<std::string> files;  ///< every file read; [0] is the scene
  ViewDescription view;
  bool has_view = false;                          ///< the file tells of it
  Color background{0};                            ///< times the environment, if there is one
  std::optional<TextureDescription> environment;  ///< an image of all directions, seen behind the scene
  double environment_turn = 0;                    ///< about y, in whole turns
  Color ambient{1};                               ///< Ia
  std::vector<Light> lights;                      ///< in the world; objects have others, and luminaires
  std::vector<DiagramDescription> diagrams;       ///< that lights name
  std::vector<SpectrumDescription> spectra;       ///< of those lights, background, ambient light and media
  std::vector<MediumDescription> media;           ///< that stand in boxes of the world
  std::vector<MaterialDescription> materials;     ///< the parts of a mix before it
  std::vector<PrincipledMaterial> principled;     ///< that materials name
  std::vector<TextureDescription> textures;
  std::vector<StructureDescription> structures;
  std::vector<LibraryDescription> libraries;
  std::vector<SkeletonDescription> skeletons;
  std::vector<ObjectDescription> objects;
  uint32_t root = 0;
  std::optional<std::array<int, 2>> frames;  ///< first and last
  bool has_own_frames = false;               ///< the scene says them; else they are those of all clips
  ClipSearch clip;                           ///< of loading
  std::vector<ClipDescription> clips;        ///< of all glTF files, played or not
  std::vector<CameraDescription> cameras;    ///< of the same
  std::vector<RenderChoice> render;          ///< how it wants to be rendered, where the user leaves it open
  Notes notes;                               ///< of loading

  SourcePlace source(const Place& p) const {
    return files.empty() ? source() : SourcePlace{files.at(p.file), p.line, p.column};
  }
  /// The scene as a whole, also if no file was read.
  SourcePlace source() const { return {files.empty() ? "the scene" : files[0]}; }
};

/// Loads a scene by its extension (.yaml, .yml or .nff; .rfp: compiled objects, seen from the front) and
/// validates it: throws InputError or IoError, and Stopped.
SceneDescription load_scene(const std::string& path, const LoadOptions& options = {});

/// The checks that hold for every format: finite numbers, planar polygons, counts, cycles, instances.
/// Throws InputError at the place of the first fault, and Stopped. Materials named nowhere else get index
/// checks here too.
void validate(const SceneDescription& scene, const std::stop_token& stop = {});

/// The instances that the object tree expands to, stopping at `most` + 1.
size_t count_instances(const SceneDescription& description, size_t most);

}  // namespace rayfarm
