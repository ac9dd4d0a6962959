#include "common/lighting/renderer.h"

#include "common/image/film.h"
#include "common/lighting/eye_rays.h"
#include "common/lighting/pixel_blocks.h"
#include "common/lighting/pulse.h"
#include "common/lighting/running_pixel.h"
#include "common/math/portable_math.h"
#include "common/sampling/warps.h"

namespace rayfarm {

/// One rectangle of the current frame.
class Renderer::Rendering {
 public:
  Rendering(Renderer& renderer, const PixelRect& rect, const RenderPass& pass,
            const std::function<void()>& pulse)
      : settings_(renderer.settings_),
        passes_(renderer.passes_),
        integrator_(*renderer.integrator_),
        filter_(renderer.filter_),
        tables_(*renderer.tables_),
        moments_(renderer.now_),
        small_objects_(renderer.small_objects_),
        eye_items_(renderer.eye_items_ ? &*renderer.eye_items_ : nullptr),
        light_items_(renderer.light_items_ ? &*renderer.light_items_ : nullptr),
        zones_(renderer.zones_),
        eye_media_(renderer.eye_media_),
        rect_(rect),
        pulse_(pulse),
        exposure_(portable_exp2(settings_.exposure_stops)),
        noise_(settings_.noise, exposure_),
        pass_(pass),
        end_(pass.end(settings_.samples)),
        film_(rect, make_pixel_layout(settings_.pixel_format)) {}

  RenderedPixels run() {
    if (settings_.sampling == SamplingPattern::corners)
      render_corners();
    else if (settings_.adaptive_contrast > 0 && settings_.samples > 1)
      render_adaptively();
    else
      render_pass();
    result_.pixels = film_.take_pixels();
    result_.not_finite = film_.not_finite();
    return std::move(result_);
  }

 private:
  template <typename Visitor>
  static void for_each_pixel(const PixelRect& rect, Visitor visit) {
    for (int y = rect.y0; y < rect.y1; ++y)
      for (int x = rect.x0; x < rect.x1; ++x) visit(Pixel{x, y});
  }

  /// Traces eye rays through `at`, for each of `ids`, in all passes of the colour model. Where the camera
  /// sees nothing there is none, and no light.
  void trace(const Moment& moment, const RasterPoints& at, std::span<const SampleId> ids,
             RenderedPixels& counted, Color* colors) {
    RayPacket rays;
    if (moment.camera.sees_all()) [[likely]] {
      rays.size = ids.size();
      aim(moment.camera, ids, at, rays);
      trace(moment, rays, at, ids, counted, colors);
      return;
    }
    RasterPoints seen;
    OfPacket<SampleId> ids_seen;
    OfPacket<size_t> places;
    std::array<Color, kMostPacketRays> colors_seen;
    for (size_t i = 0; i < ids.size(); ++i) {
      colors[i] = Color(0);
      if (!moment.camera.sees(at.x[i], at.y[i])) continue;
      seen.x[places.size()] = at.x[i];
      seen.y[places.size()] = at.y[i];
      ids_seen.push_back(ids[i]);
      places.push_back(i);
    }
    if (places.size() == 0) return;
    rays.size = places.size();
    aim(moment.camera, ids_seen.span(), seen, rays);
    trace(moment, rays, seen, ids_seen.span(), counted, colors_seen.data());
    for (size_t i = 0; i < places.size(); ++i) colors[places[i]] = colors_seen[i];
  }

  void trace(const Moment& moment, const RayPacket& rays, const RasterPoints& at,
             std::span<const SampleId> ids, RenderedPixels& counted, Color* colors) {
    OfPacket<Hit> eye_hits;
    if (eye_items_) [[unlikely]]
      eye_items_->find(moment.pose, rays, at, eye_hits.data(), counted.counts);
    for (const ColouredScene& pass : passes_) {
      const auto pass_index = static_cast<size_t>(&pass - passes_.data());
      const bool is_first = pass_index == 0;
      std::array<Color, kMostPacketRays> more;
      Color* const channels = is_first ? colors : more.data();
      counted.eye_hits +=
          integrator_.trace({pass.scene(), moment.pose, tables_, moment.camera.width(),
                             moment.camera.spread(), eye_items_ ? eye_hits.data() : nullptr, light_items_,
                             zones_.empty() ? nullptr : &zones_[pass_index], eye_media_of(moment)},
                            rays, ids, counted.counts, channels);
      if (pass.pass().is_rgb) break;
      for (size_t i = 0; i < rays.size; ++i) {
        const Color color = pass.pass().rgb_from_channels * channels[i];
        colors[i] = is_first ? color : colors[i] + color;
      }
    }
    rays_since_pulse_ += rays.size;
    if (rays_since_pulse_ < kRaysPerPulse) return;
    rays_since_pulse_ = 0;
    pulse_();
  }

  const Media* eye_media_of(const Moment& moment) const {
    return eye_media_.empty() ? nullptr : &eye_media_[static_cast<size_t>(&moment - moments_.data())];
  }

  /// The rays of a packet whose size is set.
  void aim(const Camera& camera, std::span<const SampleId> ids, const RasterPoints& at,
           RayPacket& rays) const {
    if (camera.is_pinhole()) {
      make_eye_rays(camera, at, rays);
      return;
    }
    for (size_t i = 0; i < rays.size; ++i) {
      const Ray ray = camera.ray(
          at.x[i], at.y[i],
          camera.has_lens() ? sample_disk(tables_.sampler.point(ids[i], dimension::kLens)) : Vec2(0));
      rays.set(i, ray.origin, ray.direction, ray.t_max);
    }
  }

  /// The moment of a sample. All pixels of a block share it, so that their rays stay together.
  const Moment& moment_of(const Pixel& block, uint32_t sample) const {
    if (moments_.size() == 1) return moments_.front();
    const auto r =
        random_pair(settings_.seed, tables_.sampler.frame(), {block.x, block.y, 0}, dimension::kTime);
    const uint32_t stratum = permuted(sample, settings_.samples, static_cast<uint64_t>(r[1] * 0x1p53));
    return moments_[moment_index(moments_.size(), stratum + r[0], settings_.samples)];
  }

  /// Where a sample stands, and what it weighs.
  PixelFilter::Place place_of(const SampleId& id) const {
    return filter_.sample(tables_.sampler.point(id, dimension::kScreen));
  }

  /// Samples that share a moment.
  void trace_samples(const Moment& moment, std::span<const SampleId> ids, RenderedPixels& counted,
                     Color* colors, double* weights) {
    RasterPoints at;
    for (size_t i = 0; i < ids.size(); ++i) {
      const PixelFilter::Place place = place_of(ids[i]);
      at.x[i] = ids[i].x + 0.5 + place.offset.x;
      at.y[i] = ids[i].y + 0.5 + place.offset.y;
      weights[i] = place.weight;
    }
    trace(moment, at, ids, counted, colors);
  }

  /// The samples of a pass: each pixel goes on from where the pass before left it.
  void render_pass() {
    const bool has_passes = pass_.count > 1;
    PixelMap<RunningPixel> all(has_passes ? rect_ : PixelRect(), {});
    if (pass_.index > 0)
      decode_running(pass_.before, noise_.is_set(), pass_.begin(settings_.samples), all.values());
    for_each_block(rect_, [&](const Pixel& block, const PixelRect& part) {
      OfPacket<Pixel> pixels;
      OfPacket<RunningPixel> running;
      for_each_pixel(part, [&](const Pixel& p) {
        pixels.push_back(p);
        running.push_back(has_passes ? all[p] : RunningPixel());
      });
      take_samples(block, pixels, running);
      for (size_t i = 0; i < pixels.size(); ++i) {
        write(pixels[i], running[i].mean());
        if (has_passes) all[pixels[i]] = running[i];
      }
    });
    if (!pass_.is_last()) result_.running = encode_running(all.values(), noise_.is_set());
  }

  /// What pixels still need. Those of a block that go on have equally many samples.
  void take_samples(const Pixel& block, const OfPacket<Pixel>& pixels, OfPacket<RunningPixel>& running) {
    while (true) {
      OfPacket<size_t> wanting;
      for (size_t i = 0; i < running.size(); ++i)
        if (running[i].samples < end_ && !(noise_.is_set() && noise_.is_met(running[i])))
          wanting.push_back(i);
      if (wanting.empty()) return;
      const uint32_t first = running[wanting[0]].samples, batch = first / NoiseTarget::kBatch + 1;
      add_samples(block, pixels, wanting, first,
                  noise_.is_set() ? std::min(end_, batch * NoiseTarget::kBatch) : end_, running);
    }
  }

  /// Adds the samples from `first` to `end` of some of a block's pixels. Where these do not fill a packet,
  /// the next sample's rays come along.
  void add_samples(const Pixel& block, const OfPacket<Pixel>& pixels, const OfPacket<size_t>& wanting,
                   uint32_t first, uint32_t end, OfPacket<RunningPixel>& running) {
    OfPacket<SampleId> ids;
    OfPacket<size_t> owners;
    for (uint32_t sample = first; sample < end; ++sample)
      for (const size_t i : wanting) {
        ids.push_back({pixels[i].x, pixels[i].y, sample});
        owners.push_back(i);
        const bool ends_sample = i == wanting[wanting.size() - 1];
        if (!ids.is_full() && !(ends_sample && (moments_.size() > 1 || sample + 1 == end))) continue;
        std::array<Color, kMostPacketRays> colors;
        std::array<double, kMostPacketRays> weights;
        trace_samples(moment_of(block, sample), ids.span(), result_, colors.data(), weights.data());
        for (size_t k = 0; k < owners.size(); ++k)
          if (noise_.is_set())
            running[owners[k]].add_with_squares(weights[k] * colors[k]);
          else
            running[owners[k]].add(weights[k] * colors[k]);
        ids.clear();
        owners.clear();
      }
  }

  void write(const Pixel& p, const Color& color) {
    const Color exposed = exposure_ * color;
    film_.expose(p.x, p.y, std::array{exposed.x, exposed.y, exposed.z});
  }

  /// Rays through the corners of a pixel's subpixels, which neighbours share (thesis 2.3.2, 3.4.1). Corners
  /// are counted from the image's first. A pixel is the mean of all its rays: so the directions that the
  /// thesis's model shares out over them keep the same weight.
  void render_corners() {
    const auto a = static_cast<int>(settings_.subpixels.columns),
               b = static_cast<int>(settings_.subpixels.rows);
    const auto columns = static_cast<size_t>(rect_.width() * a) + 1;
    std::vector<Color> row(columns);
    const auto trace_row = [&](int y) {
      RasterPoints at;
      OfPacket<SampleId> ids;
      for (size_t i = 0; i < columns; ++i) {
        const int x = rect_.x0 * a + static_cast<int>(i);
        // A corner belongs to what is below and right of it; the image's last corners to its last pixels.
        const auto owns = [&](int column) {
          return (column < rect_.x1 * a || column == settings_.crop.x1 * a) &&
                 (y < rect_.y1 * b || y == settings_.crop.y1 * b);
        };
        at.x[ids.size()] = static_cast<double>(x) / a;
        at.y[ids.size()] = static_cast<double>(y) / b;
        ids.push_back({x, y, 0});
        if (ids.size() < kMostPacketRays && i + 1 < columns && owns(x + 1) == owns(x)) continue;
        trace(moments_.front(), at, ids.span(), owns(x) ? result_ : counted_elsewhere_,
              &row[i + 1 - ids.size()]);
        ids.clear();
      }
    };
    std::vector<Color> sums(static_cast<size_t>(rect_.width()));
    const auto add_row = [&] {
      for (size_t x = 0; x < sums.size(); ++x)
        for (size_t i = 0; i <= settings_.subpixels.columns; ++i)
          sums[x] += row[x * settings_.subpixels.columns + i];
    };
    trace_row(rect_.y0 * b);
    for (int y = rect_.y0; y < rect_.y1; ++y) {
      std::fill(sums.begin(), sums.end(), Color(0));
      add_row();  // the last of the pixels above
      for (int i = 1; i <= b; ++i) {
        trace_row(y * b + i);
        add_row();
      }
      for (size_t x = 0; x < sums.size(); ++x)
        write({rect_.x0 + static_cast<int>(x), y},
              sums[x] / static_cast<double>(settings_.subpixels.corners()));
    }
  }

  /// More than one sample only where neighbouring samples differ (thesis 2.3.2).
  void render_adaptively() {
    PixelMap<Color> firsts = trace_first_samples();
    PixelMap<char> is_refined = find_differences(firsts);
    for_each_block(rect_, [&](const Pixel& block, const PixelRect& part) {
      OfPacket<Pixel> pixels;
      OfPacket<RunningPixel> running;
      for_each_pixel(part, [&](const Pixel& p) {
        if (!is_refined[p]) {
          write(p, firsts[p]);
          return;
        }
        pixels.push_back(p);
        running.push_back({.sum = place_of({p.x, p.y, 0}).weight * firsts[p], .samples = 1});
      });
      take_samples(block, pixels, running);
      for (size_t i = 0; i < pixels.size(); ++i) write(pixels[i], running[i].mean());
    });
  }

  /// In the rectangle and one pixel around it, as far as the picture goes: so that the choice of pixels does
  /// not depend on how it is cut.
  PixelMap<Color> trace_first_samples() {
    PixelMap<Color> firsts(
        {std::max(rect_.x0 - 1, 0), std::max(rect_.y0 - 1, 0), std::min(rect_.x1 + 1, settings_.width_px),
         std::min(rect_.y1 + 1, settings_.height_px)},
        Color(0));
    for_each_block(firsts.rect(), [&](const Pixel& block, const PixelRect& part) {
      OfPacket<SampleId> inside, around;
      for_each_pixel(part, [&](const Pixel& p) {
        (contains(rect_, p) ? inside : around).push_back({p.x, p.y, 0});
      });
      const auto trace_pixels = [&](const OfPacket<SampleId>& ids, RenderedPixels& counted) {
        if (ids.empty()) return;
        std::array<Color, kMostPacketRays> colors;
        std::array<double, kMostPacketRays> weights;
        trace_samples(moment_of(block, 0), ids.span(), counted, colors.data(), weights.data());
        for (size_t i = 0; i < ids.size(); ++i) firsts[{ids[i].x, ids[i].y}] = colors[i];
      };
      trace_pixels(inside, result_);
      trace_pixels(around, counted_elsewhere_);
    });
    return firsts;
  }

  bool differ(const Color& a, const Color& b) const {
    return max_magnitude(a - b) > settings_.adaptive_contrast;
  }

  PixelMap<char> find_differences(PixelMap<Color>& firsts) {
    PixelMap<char> differs(rect_, 0);
    for_each_pixel(rect_, [&](const Pixel& p) {
      for (int y = p.y - 1; y <= p.y + 1; ++y)
        for (int x = p.x - 1; x <= p.x + 1; ++x)
          if (contains(firsts.rect(), {x, y}) && differ(firsts[{x, y}], firsts[p])) differs[p] = 1;
    });
    // What first samples miss: rays to the centres of small objects.
    auto next = std::lower_bound(small_objects_.begin(), small_objects_.end(), rect_.y0,
                                 [](const SmallObject& o, int y) { return o.y < y; });
    Pixel last{-1, -1};
    for (uint32_t in_pixel = 0; next != small_objects_.end() && next->y < rect_.y1; ++next) {
      const Pixel p{next->x, next->y};
      in_pixel = p.x == last.x && p.y == last.y ? in_pixel + 1 : 0;
      last = p;
      if (!contains(rect_, p) || differs[p]) continue;
      if (in_pixel >= settings_.samples) {  // as many objects as there could be samples
        differs[p] = 1;
        continue;
      }
      const SampleId id{p.x, p.y, 0};
      const Camera& camera = moments_.front().camera;
      if (!camera.sees(next->center.x, next->center.y)) continue;
      const Ray ray = camera.ray(next->center.x, next->center.y);
      Color color(0);
      RasterPoints at;
      at.x[0] = next->center.x;
      at.y[0] = next->center.y;
      trace(moments_.front(), RayPacket(std::span(&ray, 1)), at, std::span(&id, 1), result_, &color);
      if (differ(color, firsts[p])) differs[p] = 1;
    }
    return differs;
  }

  const RenderSettings& settings_;
  std::span<const ColouredScene> passes_;
  Integrator& integrator_;
  const PixelFilter& filter_;
  const SamplingTables& tables_;
  std::span<const Moment> moments_;
  std::span<const SmallObject> small_objects_;
  EyeItems* eye_items_;            ///< null: none
  const LightItems* light_items_;  ///< null: none
  std::span<const ZoneLight> zones_;
  const std::vector<Media>& eye_media_;
  PixelRect rect_;
  const std::function<void()>& pulse_;
  double exposure_;
  NoiseTarget noise_;
  RenderPass pass_;
  uint32_t end_;  ///< of the samples of the pass
  Film film_;
  size_t rays_since_pulse_ = 0;
  RenderedPixels result_;
  RenderedPixels counted_elsewhere_;  ///< for neighbours
};

RenderedPixels Renderer::render(int frame, const PixelRect& rect, const std::function<void()>& pulse,
                                const RenderPass& pass) {
  if (frame_ != frame) set_frame(frame);
  return Rendering(*this, rect, pass, pulse).run();
}

}  // namespace rayfarm
