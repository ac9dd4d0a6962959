#include "common/description/formats/gltf/nodes.h"

#include <fmt/core.h>

#include <numbers>

#include "common/math/portable_math.h"

namespace rayfarm {

using std::numbers::pi;

namespace {

constexpr size_t kMostDepth =
    limits::kObjectDepth - 100;  // of nodes: the scene may use the file deep in itself

/// True of a light that Blender's exporter has most likely written in its usual units, "Standard": a watt is
/// 683 lumens there, and the strength of a sun 683 lux. Lamps of 18 W and suns of 0.15 are above these limits
/// then; those written as "Unitless" are so from 12,600 W and a strength of 100 on. The file does not tell.
bool is_of_standard_units(const std::string& type, double intensity) {
  return intensity > (type == "directional" ? 100 : 1000);
}

}  // namespace

GltfNodes::GltfNodes(const GltfFile& file, SceneDescription& scene, const GltfAnimation& animation,
                     const Place& place)
    : file_(file),
      scene_(scene),
      animation_(animation),
      place_(place),
      materials_(file, scene),
      meshes_(file, scene, materials_, place),
      parents_(file.count("nodes"), kNone),
      objects_(parents_.size(), kNone),
      bones_(parents_.size(), kNone) {
  if (parents_.size() > limits::kObjects) file.root().fail("the file has too many nodes");
  for (uint32_t i = 0; i < parents_.size(); ++i) {
    const auto children = file.item("nodes", i).find("children");
    for (size_t k = 0; children && k < children->size(); ++k) {
      const uint64_t child = (*children)[k].whole_number();
      if (child >= parents_.size()) (*children)[k].fail("there is no such node");
      if (parents_[child] != kNone)
        (*children)[k].fail(fmt::format("node {} is a child of node {} already; a node has one parent", child,
                                        parents_[child]));
      parents_[child] = i;
    }
  }
  check_tree();
}

void GltfNodes::check_tree() const {
  enum class Seen : uint8_t { no, on_the_way, done };
  std::vector<Seen> seen(parents_.size(), Seen::no);
  for (uint32_t i = 0; i < parents_.size(); ++i) {
    uint32_t node = i;
    for (; node != kNone && seen[node] == Seen::no; node = parents_[node]) seen[node] = Seen::on_the_way;
    if (node != kNone && seen[node] == Seen::on_the_way)
      file_.item("nodes", node).fail("it contains itself, by its children; break the circle");
    for (uint32_t done = i; done != kNone && seen[done] == Seen::on_the_way; done = parents_[done])
      seen[done] = Seen::done;
  }
}

std::vector<uint32_t> GltfNodes::roots() const {
  std::vector<uint32_t> roots;
  if (file_.count("scenes") == 0) {
    for (uint32_t i = 0; i < parents_.size(); ++i)
      if (parents_[i] == kNone) roots.push_back(i);
    return roots;
  }
  const uint32_t chosen = file_.root().index("scene", file_.count("scenes"));
  const auto nodes = file_.item("scenes", chosen == kNone ? 0 : chosen).find("nodes");
  std::vector<bool> is_root(parents_.size());
  for (size_t i = 0; nodes && i < nodes->size(); ++i) {
    const uint64_t node = (*nodes)[i].whole_number();
    if (node >= parents_.size()) (*nodes)[i].fail("there is no such node");
    if (is_root[node]) (*nodes)[i].fail("it stands here twice");
    is_root[node] = true;
    roots.push_back(static_cast<uint32_t>(node));
  }
  for (const uint32_t root : roots)
    if (parents_[root] != kNone)
      nodes->fail(fmt::format("node {} is a child of node {}, and no root", root, parents_[root]));
  return roots;
}

void GltfNodes::collect(const std::vector<uint32_t>& roots) {
  std::vector<std::pair<uint32_t, size_t>> open;  // nodes and their depths
  for (size_t i = roots.size(); i-- > 0;) open.emplace_back(roots[i], 1);
  while (!open.empty()) {
    const auto [node, depth] = open.back();
    open.pop_back();
    const GltfValue value = file_.item("nodes", node);
    if (depth > kMostDepth) value.fail(fmt::format("nodes are nested more than {} deep", kMostDepth));
    order_.push_back(node);
    if (value.has("matrix") && (value.has("translation") || value.has("rotation") || value.has("scale")))
      ++doubled_places_;
    if (const auto children = value.find("children"))
      for (size_t i = children->size(); i-- > 0;)
        open.emplace_back(static_cast<uint32_t>((*children)[i].whole_number()), depth + 1);
  }
}

uint32_t GltfNodes::add_object(std::string name) {
  if (scene_.objects.size() >= limits::kObjects) file_.root().fail("the scene has too many objects");
  scene_.objects.push_back({std::move(name), {}, {}, place_});
  return static_cast<uint32_t>(scene_.objects.size() - 1);
}

uint32_t GltfNodes::object_of(uint32_t node) {
  // From the node up to the first that has an object, and down again.
  std::vector<uint32_t> missing;
  for (; node != kNone && objects_[node] == kNone; node = parents_[node]) missing.push_back(node);
  uint32_t above = node == kNone ? root_ : objects_[node];
  for (size_t i = missing.size(); i-- > 0;) {
    const uint32_t object = add_object(file_.name_of(file_.item("nodes", missing[i])));
    objects_[missing[i]] = object;
    scene_.objects[above].children.push_back({object, animation_.transform_of(missing[i]), place_});
    above = object;
  }
  return above;
}

void GltfNodes::make_skeleton() {
  // The joints of all skins, and what they hang on.
  std::vector<bool> is_shown(parents_.size()), is_bone(parents_.size());
  for (const uint32_t node : order_) is_shown[node] = true;
  for (size_t s = 0; s < file_.count("skins"); ++s) {
    const GltfValue joints = file_.item("skins", s).at("joints");
    for (size_t j = 0; j < joints.size(); ++j) {
      const uint64_t joint = joints[j].whole_number();
      if (joint >= parents_.size()) joints[j].fail("there is no such node");
      for (auto node = static_cast<uint32_t>(joint); node != kNone && !is_bone[node]; node = parents_[node])
        is_bone[node] = true;
    }
  }
  if (std::none_of(order_.begin(), order_.end(), [&](uint32_t n) { return is_bone[n]; })) return;
  SkeletonDescription skeleton;
  skeleton.place = place_;
  for (const uint32_t node : order_) {
    if (!is_bone[node]) continue;
    bones_[node] = static_cast<uint32_t>(skeleton.bones.size());
    skeleton.bones.push_back(
        {parents_[node] == kNone ? kNone : bones_[parents_[node]], animation_.transform_of(node)});
  }
  skeleton_ = static_cast<uint32_t>(scene_.skeletons.size());
  scene_.skeletons.push_back(std::move(skeleton));
}

std::optional<std::vector<DeformationDescription::Joint>> GltfNodes::joints_of(uint32_t skin) {
  const GltfValue value = file_.item("skins", skin), list = value.at("joints");
  std::vector<DeformationDescription::Joint> joints(list.size());
  for (size_t j = 0; j < joints.size(); ++j) {
    joints[j].bone = bones_[list[j].whole_number()];
    if (joints[j].bone == kNone) return std::nullopt;  // it is in another scene of the file
  }
  const uint32_t matrices = value.index("inverseBindMatrices", file_.count("accessors"));
  if (joints.empty()) empty_skins_.insert(skin);
  if (matrices == kNone || joints.empty()) return joints;
  const GltfAccessor accessor(file_, matrices);
  accessor.expect_components({16});
  if (accessor.count() < joints.size())
    value.at("inverseBindMatrices").fail("there are fewer than the skin has joints");
  const LargeVector<float> m = accessor.all<float>();
  for (size_t j = 0; j < joints.size(); ++j) {
    Affine& bone_from_mesh = joints[j].bone_from_mesh;
    for (int column = 0; column < 4; ++column) {
      const float* const from = &m[16 * j + 4 * static_cast<size_t>(column)];
      (column < 3 ? bone_from_mesh.linear[column] : bone_from_mesh.translation) = {from[0], from[1], from[2]};
      if (!is_finite({from[0], from[1], from[2]}))
        value.at("inverseBindMatrices").fail(fmt::format("the {}. matrix has numbers that are none", j + 1));
    }
  }
  return joints;
}

void GltfNodes::add_shared(uint32_t node, uint32_t mesh) {
  const auto [known, is_new] = mesh_objects_.try_emplace(mesh, kNone);
  if (is_new) {
    std::vector<PrimitiveDescription> primitives = meshes_.primitives(mesh, nullptr);
    if (primitives.empty()) return;
    known->second = add_object(file_.name_of(file_.item("meshes", mesh)));
    scene_.objects[known->second].primitives = std::move(primitives);
  }
  if (known->second == kNone) return;
  const uint32_t user = object_of(node);
  for (std::vector<TransformStep>& copy : copies_of(file_.item("nodes", node)))
    scene_.objects[user].children.push_back({known->second, std::move(copy), place_});
}

void GltfNodes::add_mesh(uint32_t node, uint32_t mesh) {
  const GltfValue value = file_.item("nodes", node);
  const uint32_t skin = value.index("skin", file_.count("skins"));
  const size_t targets = file_.morph_targets(mesh);
  if (targets == 0 && (value.has("weights") || file_.item("meshes", mesh).has("weights"))) ++idle_weights_;
  if (skin == kNone && targets == 0) return add_shared(node, mesh);
  GltfDeformer deformer;
  if (skin != kNone) {
    auto joints = joints_of(skin);
    if (!joints) {
      ++hidden_skins_;
      return;
    }
    deformer.skeleton = skeleton_;
    deformer.joints = std::move(*joints);
  }
  deformer.weights = animation_.weights_of(node, targets);
  Copies& all = copies_[{mesh, skin != kNone}];
  deformer.is_copy = all.is_read;
  std::vector<PrimitiveDescription> primitives = meshes_.primitives(mesh, &deformer);
  if (!std::exchange(all.is_read, true)) take_copies(value, primitives, all.nodes - 1);
  std::vector<std::vector<TransformStep>> copies = copies_of(value);
  // A mesh with a skin moves with its bones alone; others, and what of it has no joints, with the node.
  uint32_t in_skin = kNone, in_node = kNone, as_it_is = kNone;
  for (PrimitiveDescription& primitive : primitives) {
    const auto& deformation = std::get<MeshShape>(primitive.shape).deformation;
    const bool is_skinned = deformation && deformation->skeleton != kNone;
    uint32_t& object = is_skinned ? in_skin : deformation ? in_node : as_it_is;
    if (object == kNone) {
      object = add_object(file_.name_of(value));
      const uint32_t user = is_skinned ? root_ : object_of(node);
      if (is_skinned) skinned_copies_ += copies.size() - 1;
      for (const std::vector<TransformStep>& copy : copies) {
        scene_.objects[user].children.push_back(
            {object, is_skinned ? std::vector<TransformStep>() : copy, place_});
        if (is_skinned) break;  // all of them would stand in its place
      }
    }
    scene_.objects[object].primitives.push_back(std::move(primitive));
  }
}

void GltfNodes::add_light(uint32_t node, const GltfValue& use) {
  const auto all = file_.root().extension("KHR_lights_punctual");
  if (!all) use.fail("the file lists no lights");
  const GltfValue lights = all->at("lights");
  const uint32_t index = use.index("light", lights.size());
  if (index == kNone) use.at("light");
  const GltfValue value = lights[index];
  LightDescription light;
  light.place = place_;
  light.light.direction = {0, 0, -1};
  Color color(1);
  if (const auto v = value.find("color")) {
    color = v->vector3();
    if (color.x < 0 || color.y < 0 || color.z < 0) v->fail("a light's colour can't be negative");
  }
  const double intensity = value.number_in("intensity", 1, 0, 1e12);
  light.light.color = color * intensity;
  const std::string type = value.at("type").text();
  if (type == "directional") {
    light.light.kind = LightKind::distant;
    light.light.color /= pi;  // from what falls on a surface to what a white one shows of it
  } else if (type == "point") {
    light.light.kind = LightKind::bulb;
  } else if (type == "spot") {
    light.light.kind = LightKind::spot;
    double inner = 0, outer = pi / 4;
    if (const auto spot = value.find("spot")) {
      outer = spot->number_in("outerConeAngle", pi / 4, 1e-6, pi / 2 + 1e-6);
      inner = spot->number_in("innerConeAngle", 0, 0, pi / 2);
      wide_cones_ += inner > outer ? 1 : 0;
      inner = std::min(inner, 0.999 * outer);
    }
    light.light.cosine_full = portable_cos(inner);
    light.light.cosine_none = portable_cos(std::min(outer, pi / 2));
  } else {
    value.at("type").fail("directional, point or spot was expected");
  }
  if (value.has("range")) ++ranges_;
  if (light.light.color == Color(0)) {
    ++dark_lights_;
    return;
  }
  strong_lights_ += is_of_standard_units(type, intensity) ? 1 : 0;
  if (++light_count_ > limits::kLights) value.fail("the file has too many lights");
  scene_.objects[object_of(node)].lights.push_back(std::move(light));
}

void GltfNodes::add_content(uint32_t node) {
  throw_if_stopped(file_.options().stop);
  const GltfValue value = file_.item("nodes", node);
  if (const uint32_t mesh = value.index("mesh", file_.count("meshes")); mesh != kNone) add_mesh(node, mesh);
  if (const auto light = value.extension("KHR_lights_punctual")) add_light(node, *light);
  const uint32_t camera = value.index("camera", file_.count("cameras"));
  if (camera == kNone) return;
  GltfPlacedCamera placed{camera, file_.item("cameras", camera).text("name", ""), {}};
  if (placed.name.empty()) placed.name = file_.name_of(value);
  for (uint32_t above = node; above != kNone; above = parents_[above]) placed.nodes.push_back(above);
  std::reverse(placed.nodes.begin(), placed.nodes.end());
  cameras_.push_back(std::move(placed));
}

uint32_t GltfNodes::add_all() {
  root_ = add_object(file_.path());
  collect(roots());
  make_skeleton();
  count_copies();
  for (const uint32_t node : order_) add_content(node);
  scene_.files.insert(scene_.files.end(), file_.files().begin(), file_.files().end());
  return root_;
}

void GltfNodes::add_notes() {
  meshes_.add_notes();
  const auto add = [&](const std::string& text) { scene_.notes.add({file_.path()}, text); };
  if (ranges_ > 0)
    add(
        fmt::format("`range` of {} lights is not used: their light goes on, and falls with the "
                    "square of the distance",
                    ranges_));
  const auto asset = file_.root().find("asset");
  if (strong_lights_ > 0 && asset && asset->text("generator", "").find("Blender") != std::string::npos)
    add(fmt::format(
        "{} of its lights are as strong as Blender writes them in its lighting mode \"Standard\", 683 "
        "times their watts: if the picture is white, add `--exposure -9.4`, or export with the mode "
        "\"Unitless\"",
        strong_lights_));
  if (dark_lights_ > 0) add(fmt::format("{} lights without any light are left out", dark_lights_));
  if (wide_cones_ > 0)
    add(fmt::format("of {} spots the inner cone is wider than the outer, and taken for as wide",
                    wide_cones_));
  if (hidden_skins_ > 0)
    add(fmt::format("{} meshes whose skins have joints that the scene doesn't show are left out",
                    hidden_skins_));
  if (skinned_copies_ > 0)
    add(
        fmt::format("{} copies that EXT_mesh_gpu_instancing makes of meshes with skins are left out: such a "
                    "mesh stands where its joints are, and all its copies would stand in one place",
                    skinned_copies_));
  for (const uint32_t skin : empty_skins_)
    add(fmt::format("skins[{}] has no joints: meshes stand in it as they are without a skin", skin));
  if (idle_weights_ > 0)
    add(fmt::format("`weights` of {} nodes are not used: their meshes have no morph targets", idle_weights_));
  if (doubled_places_ > 0)
    add(fmt::format(
        "translation, rotation or scale of {} nodes is not used: they have a `matrix`, too, which "
        "glTF does not allow, and which counts where no clip moves them",
        doubled_places_));
  if (const size_t scenes = file_.count("scenes"); scenes > 1)
    add(fmt::format("of {} scenes one is shown, that of its `scene`, or the first", scenes));
}

}  // namespace rayfarm
