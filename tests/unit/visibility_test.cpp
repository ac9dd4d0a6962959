// Objects that come and go between frames (thesis 2.6.1: "objects are added to, or deleted from, the
// hierarchy by simply making or breaking the appropriate links between nodes"; 4.2.1.1; Figure 4.4).
#include "common/lighting/frame_lights.h"
#include "common/lighting/renderer.h"
#include "tests/unit/test_scene.h"

namespace rayfarm {
namespace {

const char* kHead = R"(
view: {location: [0, 1, 5], look_at: [0, 0.5, 0], field_of_view: 50}
frames: [0, 5]
lights: [{position: [2, 4, 3], color: 0.5}, {direction: [0.2, -1, -0.3], color: 0.2}]
materials:
  white: {color: 0.8}
  shiny: {color: 0.6, reflect: 0.3, specular: 0.3}
  lamp: {luminaire: {emission: [3, 2, 1]}}
objects:
  pair: [{material: shiny, sphere: {center: [0, 0, 0], radius: 0.3}}, {material: lamp, sphere: {center: [0.5, 0.4, 0], radius: 0.1}}]
scene:
  - {material: white, polygon: {points: [[-4, 0, 4], [4, 0, 4], [4, 0, -4], [-4, 0, -4]]}}
  - {material: lamp, polygon: {points: [[-1, 3, -1], [1, 3, -1], [1, 3, 1], [-1, 3, 1]]}}
  - {material: shiny, sphere: {center: [-1, 0.5, 0], radius: 0.5}, transform: {translate: {0: [0, 0, 0], 5: [0.6, 0, 0.3]}}}
)";

/// What comes and goes, with the frames in which each is there.
struct Guest {
  std::string node;
  std::string visible;
  std::vector<bool> is_there;  ///< by frame
};
const std::vector<Guest>& guests() {
  static const std::vector<Guest> all{
      {"use: pair, transform: {translate: [1, 0.4, 0.5]}",
       "{0: false, 2: true, 4: false}",
       {0, 0, 1, 1, 0, 0}},
      // A group with a moving node inside that itself comes and goes.
      {"transform: {translate: {0: [0, 0, 0], 5: [1, 0, 0]}}, group: [{use: pair, transform: {translate: "
       "[-0.5, 1.2, "
       "0]}}, {material: white, box: {min: [0.2, 0, 1], max: [0.6, 0.9, 1.4]}}]",
       "{0: true, 3: false, 5: true}",
       {1, 1, 1, 0, 0, 1}},
      {"light: {position: [0, 1.5, 1], falloff: true, color: [0.2, 0.6, 0.9]}, transform: {translate: {0: "
       "[0, 0, 0], "
       "5: [1, 0, 0]}}",
       "{1: true, 2: false}",
       {1, 1, 0, 0, 0, 0}},
      // Far outside of all else: what it is missed by decides the scene's size.
      {"material: lamp, transform: {translate: [30, 5, -40]}, sphere: {center: [0, 0, 0], radius: 3}",
       "{0: false, 1.5: true}",
       {0, 0, 1, 1, 1, 1}},
      {"material: shiny, transform: {translate: [0, 0.4, 2]}, sphere: {center: [0, 0, 0], radius: 0.4}",
       "false",
       {0, 0, 0, 0, 0, 0}},
      {"material: shiny, transform: {translate: [1.7, 0.3, 1]}, sphere: {center: [0, 0, 0], radius: 0.3}",
       "true",
       {1, 1, 1, 1, 1, 1}}};
  return all;
}

CompiledScene with_guests() {
  std::string text = kHead;
  for (const Guest& guest : guests())
    text += fmt::format("  - {{{}, visible: {}}}\n", guest.node, guest.visible);
  return compile(test::load_yaml(text));
}

/// The scene of one frame's guests alone, all of them there in every frame.
CompiledScene of_frame(size_t frame) {
  std::string text = kHead;
  for (const Guest& guest : guests())
    if (guest.is_there[frame]) text += fmt::format("  - {{{}}}\n", guest.node);
  return compile(test::load_yaml(text));
}

RenderSettings settings_of(LightingModel model) {
  RenderSettings settings = test::picture_settings(36, 26, model);
  settings.samples = 2;
  settings.max_depth = 4;
  return settings;
}

constexpr LightingModel kModels[] = {LightingModel::phong, LightingModel::whitted, LightingModel::thesis,
                                     LightingModel::path};

TEST(Visibility, PicturesAreThoseOfScenesWithoutWhatIsHidden) {
  const CompiledScene all = with_guests();
  for (const LightingModel model : kModels) {
    const RenderSettings settings = settings_of(model);
    Renderer renderer(all.scene, settings);
    for (int frame = 0; frame <= 5; ++frame) {
      SCOPED_TRACE(fmt::format("model {}, frame {}", static_cast<int>(model), frame));
      const CompiledScene alone = of_frame(static_cast<size_t>(frame));
      EXPECT_EQ(renderer.render(frame, settings.crop, [] {}).pixels,
                Renderer(alone.scene, settings).render(frame, settings.crop, [] {}).pixels);
    }
  }
}

TEST(Visibility, PicturesAreThoseWithoutInSpectralColoursAndWhileTheShutterIsOpen) {
  const CompiledScene all = with_guests();
  for (const bool is_spectral : {false, true}) {
    RenderSettings settings = settings_of(LightingModel::path);
    settings.shutter =
        is_spectral ? 0 : 2;  // longer than a frame: what is there is there by the frame's number
    settings.samples = 4;
    settings.adaptive_contrast = 0;
    if (is_spectral) settings.colour = ColourModel::meyer4;
    Renderer renderer(all.scene, settings);
    for (const int frame : {4, 1, 3})
      EXPECT_EQ(renderer.render(frame, settings.crop, [] {}).pixels,
                Renderer(of_frame(static_cast<size_t>(frame)).scene, settings)
                    .render(frame, settings.crop, [] {})
                    .pixels)
          << frame;
  }
}

TEST(Visibility, AFrameDependsOnItsNumberAlone) {
  const CompiledScene all = with_guests();
  const RenderSettings settings = settings_of(LightingModel::path);
  Renderer one_after_the_other(all.scene, settings);
  for (const int frame : {5, 0, 2, 2, 4, 1, 3})
    EXPECT_EQ(one_after_the_other.render(frame, settings.crop, [] {}).pixels,
              Renderer(all.scene, settings).render(frame, settings.crop, [] {}).pixels)
        << frame;
}

TEST(Visibility, NoRayMeetsWhatIsHidden) {
  const CompiledScene all = with_guests();
  FrameState state(all.scene);
  std::mt19937 random(2);
  for (int frame = 0; frame <= 5; ++frame) {
    const Pose pose = state.at(frame);
    const std::vector<char> visible = visible_nodes(all.scene, frame);
    const auto is_there = [&](const Hit& hit) {
      return visible[all.scene.instances[hit.instance].object_node];
    };
    std::vector<Ray> rays;
    for (int i = 0; i < 800; ++i) {
      const Vec3 from = test::random_point(random, 6);
      rays.push_back({from, normalized(test::random_point(random, 2) - from)});
    }
    for (size_t i = 0; i < rays.size(); i += 8) {
      std::array<Hit, 8> hits;
      const RayPacket packet{std::span(rays).subspan(i, 8)};
      closest_hits(all.scene, pose, packet, hits.data());
      const uint32_t any = any_hits(all.scene, pose, packet);
      for (size_t k = 0; k < 8; ++k) {
        const Hit slow = closest_hit_brute_force(all.scene, pose, packet[k]);
        EXPECT_EQ(hits[k].t, slow.t);
        EXPECT_EQ(hits[k].instance, slow.instance);
        EXPECT_EQ(any >> k & 1, slow.is_hit() ? 1u : 0u);
        EXPECT_TRUE(!slow.is_hit() || is_there(slow));
      }
    }
  }
}

TEST(Visibility, WhatIsHiddenIsNoSourceOfLight) {
  const CompiledScene all = with_guests();
  const std::vector<LightPower> powers = light_powers(all.scene);
  for (uint32_t frame = 0; frame <= 5; ++frame) {
    const FrameLights lights = make_frame_lights(all.scene, powers, frame);
    // Two listed ones, the ceiling, and one luminaire of each pair and of the far lamp.
    const auto& g = guests();
    EXPECT_EQ(lights.shining.size(),
              3u + g[0].is_there[frame] + g[1].is_there[frame] + g[2].is_there[frame] + g[3].is_there[frame]);
    EXPECT_EQ(lights.first_luminaire, 2u + g[2].is_there[frame]);
    const CompiledScene alone = of_frame(frame);
    EXPECT_TRUE(std::equal(lights.shares.begin(), lights.shares.end(), alone.scene.light_shares.begin(),
                           alone.scene.light_shares.end()));
    EXPECT_EQ(lights.far_away, alone.scene.head().far_away);
  }
}

TEST(Visibility, PartsAreNeverBuiltAgain) {
  // 4.3.3.1: "the object/volume hierarchy is not rebuilt between frames"; the tree of moving objects keeps
  // its shape, and only its boxes change.
  const CompiledScene all = with_guests();
  FrameState state(all.scene);
  for (int frame = 0; frame <= 5; ++frame) {
    const VolumeNode* nodes = state.at(frame).moving_nodes();
    for (size_t i = 0; i < all.scene.moving_nodes.size(); ++i)
      for (size_t slot = 0; slot < 8; ++slot) {
        EXPECT_EQ(nodes[i].children[slot].first, all.scene.moving_nodes[i].children[slot].first);
        EXPECT_EQ(nodes[i].children[slot].meta, all.scene.moving_nodes[i].children[slot].meta);
      }
  }
}

TEST(Visibility, WhatIsNeverThereLeavesNoInstance) {
  const std::string text = test::view_text() + "scene: [{sphere: {center: [0, 0, 0], radius: 1}}";
  const auto instances = [&](const std::string& visible) {
    return compile(test::load_yaml(
                       text + fmt::format(", {{sphere: {{center: [0, 0, 0], radius: 1}}, visible: {}}}]\n",
                                          visible)))
        .scene.instances.size();
  };
  EXPECT_EQ(instances("false"), 1u);
  EXPECT_EQ(instances("{1: false, 2: false}"), 1u);
  EXPECT_EQ(instances("{1: false, 2: true}"), 2u);
  EXPECT_EQ(instances("true"), 2u);
}

TEST(Visibility, WhatCannotBeMeantIsRefusedWithItsPlace) {
  const auto error = [](const std::string& visible) {
    return test::error_of(test::view_text() +
                          "scene:\n  - {sphere: {center: [0, 0, 0], radius: 1}, visible: " + visible + "}\n");
  };
  EXPECT_NE(error("yes").find("scene.yaml:3:"), std::string::npos) << error("yes");
  EXPECT_NE(error("yes").find("unknown visible 'yes' (known: false, true)"), std::string::npos)
      << error("yes");
  EXPECT_NE(error("{1: 3}").find("unknown 1 '3'"), std::string::npos) << error("{1: 3}");
  EXPECT_NE(error("{on: true}").find("'on' is not a frame number"), std::string::npos) << error("{on: true}");
  EXPECT_NE(error("{}").find("visible has no keys"), std::string::npos) << error("{}");
  EXPECT_NE(error("{2: true, 2.0: false}").find("twice"), std::string::npos)
      << error("{2: true, 2.0: false}");
  EXPECT_NE(test::error_of(test::view_text() +
                           "scene: [{sphere: {center: [0, 0, 0], radius: 1}, visibel: false}]\n")
                .find("did you mean 'visible'"),
            std::string::npos);
}

TEST(Visibility, AHiddenLampDoesNotLightTheScene) {
  const auto notes = [](const std::string& visible) {
    return test::notes_of(
        test::view_text() +
        "materials: {lamp: {luminaire: {emission: 1}}, black: {lambertian: 0.5}}\nscene:\n  - "
        "{material: black, sphere: {center: [0, 0, 0], radius: 1}}\n"
        "  - {material: lamp, sphere: {center: [0, 3, 0], radius: 1}, visible: " +
        visible + "}\n");
  };
  EXPECT_NE(notes("false").find("nothing lights the scene"), std::string::npos) << notes("false");
  EXPECT_EQ(notes("{0: false, 3: true}"), "");
}

}  // namespace
}  // namespace rayfarm
