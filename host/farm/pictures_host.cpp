#include "host/farm/pictures_host.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "protocol/block_codec.h"

namespace rayfarm {

PicturesHost::PicturesHost(Transport& transport, const FarmHostOptions& options, JobResult& result,
                           const Tell& tell, Assignment& assignment)
    : transport_(transport),
      options_(options),
      result_(result),
      tell_(tell),
      assignment_(assignment),
      phase_(PicturesPhase{{}, options.plan.pictures.grid, {}}),
      files_(options, result, tell),
      journal_(options.journals.every_s),
      has_journal_(options.files.size()),
      pixels_of_node_(static_cast<size_t>(options.plan.processors) + 1),
      step_of_node_(pixels_of_node_.size()) {
  const PicturesPhase& all = options.plan.pictures;
  for (FrameIndex i; i.place() < all.frames.size(); ++i) {
    FrameResult frame;
    frame.frame = all.frames[i.place()];
    index_of_frame_[frame.frame] = i;
    frame.file = options.files[i.place()];
    result_.frames.push_back(frame);
  }
}

void PicturesHost::begin(const FrameGroup& group) {
  phase_ = phase_of(options_.plan,
                    {0, PhaseKind::pictures, group.first.value(), static_cast<uint64_t>(group.count), 1, 0});
  is_at_work_ = true;
  std::fill(step_of_node_.begin(), step_of_node_.end(), std::nullopt);
  resumed_.clear();
  room_step_ = StepIndex();
}

PhaseWork PicturesHost::work() {
  PhaseWork work;
  work.steps = pictures().steps();
  work.items_per_step = pictures().items_per_step();
  const bool has_passes = pictures().passes > 1;
  // A pass goes on from the whole of the one before.
  work.window_steps = has_passes ? 1 : options_.window_frames;
  if (!options_.journals.found.empty() || has_passes)
    work.is_done = [this](ItemIndex item) { return needs_no_work(item); };
  if (options_.plan.policy == AssignmentPolicy::interleaved)
    work.owner_of = [this](ItemIndex item) { return owner_of(options_.plan, pictures(), item); };
  else if (options_.is_streamed())
    work.allowed_end = end_of_room();
  return work;
}

ItemIndex PicturesHost::end_of_room() {
  if (room_step_.value() == pictures().steps()) return ItemIndex(std::numeric_limits<int64_t>::max());
  const FrameIndex frame = of_job(room_step_);
  files_.begin(frame);
  return pictures().item_of(room_step_, files_.end_of_room(frame));
}

void PicturesHost::release(StepIndex step, double now) {
  if (is_last_pass(step)) resumed_.erase(of_job(step));
  room_step_ = std::max(room_step_, StepIndex(step.value() + 1));
  assignment_.release(step, now);
}

void PicturesHost::assign(const AssignItem& assign) {
  const StepIndex step = pictures().step_of(assign.item);
  std::optional<StepIndex>& selected = step_of_node_[assign.node.place()];
  if (selected != step) transport_.send(assign.node, SelectStep{step});
  selected = step;
  if (pictures().pass_of(step) > 0)
    transport_.send(assign.node,
                    GoOnFrom{files_.running(of_job(step), pictures().subpolygon_of(assign.item))});
  transport_.send(assign.node, Channel::command,
                  encode_display_polygon(processor_of(assign.node), pictures().polygon_of(assign.item)));
}

std::string PicturesHost::name_of(ItemIndex item) const {
  return fmt::format("subpolygon {} of frame {}{}", pictures().subpolygon_of(item).value(),
                     pictures().number_of(item).value(),
                     pictures().passes > 1
                         ? fmt::format(" in pass {}", pictures().pass_of(pictures().step_of(item)) + 1)
                         : "");
}

void PicturesHost::complete(StepIndex step, double now) {
  const FrameIndex frame = of_job(step);
  const bool has_failed = !result_.frames[frame.place()].problem.empty();  // in an earlier pass
  if (!has_failed && is_last_pass(step)) {
    files_.complete(frame);
    return;
  }
  if (!has_failed) files_.write_pass(frame, pictures().pass_of(step));
  release(step, now);
}

void PicturesHost::fail(const StepFailed& failed, double now) {
  const FrameIndex index = of_job(failed.step);
  FrameResult& frame = result_.frames[index.place()];
  files_.drop(index);
  frame.problem = fmt::format("a subpolygon failed three times: {}", failed.problem);
  tell_(fmt::format("frame {} failed: {}", frame.frame.value(), frame.problem));
  release(failed.step, now);
}

void PicturesHost::forget(NodeId node) {
  pixels_of_node_[node.place()] = std::vector<PixelResult>();
  step_of_node_[node.place()].reset();
}

void PicturesHost::check(const SubpolygonReport& report) const {
  if (!index_of_frame_.contains(report.frame)) throw ProtocolError("a frame that was not asked for");
  if (report.subpolygon < SubpolygonId() || report.subpolygon.value() >= pictures().items_per_step())
    throw ProtocolError("a subpolygon that does not exist");
}

std::optional<ItemIndex> PicturesHost::item_of(const SubpolygonReport& report, int pass) const {
  const int frame = index_of_frame_.at(report.frame).value() - pictures().first.value();
  if (frame < 0 || static_cast<size_t>(frame) >= pictures().frames.size() || pass >= pictures().passes)
    return std::nullopt;
  return pictures().item_of(pictures().step_of(FrameIndex(frame), pass), report.subpolygon);
}

void PicturesHost::receive_block(NodeId node, Bytes message, double now) {
  const BlockResult block = decode_block(message);
  check(block.report);
  if (!block.is_compressed) {
    const size_t net_bytes = block.pixels.size();
    keep_block({node, std::move(message), block, net_bytes, {}, {}, {}}, now);
    return;
  }
  const DisplayPolygon p = pictures().grid.polygon(block.report.subpolygon);
  decoders_.submit(node, std::move(message), block, p.right - p.left + 1, p.bottom - p.top + 1);
}

void PicturesHost::keep_block(const BlockDecoders::Decoded& decoded, double now) {
  if (!decoded.problem.empty()) throw ProtocolError(decoded.problem);
  if (keep_result(decoded.node, decoded.block, decoded.net_bytes, now))
    journal_.append(journal_of(file_of(decoded.block.report.frame)), decoded.message);
}

void PicturesHost::receive_pixels(NodeId node, std::span<const std::byte> bytes) {
  ByteReader reader(bytes);
  auto& pixels = pixels_of_node_[node.place()];
  if (pixels.size() > static_cast<size_t>(options_.image.window.area()))
    throw ProtocolError("more pixels than the image has");
  while (!reader.at_end()) pixels.push_back(read_pixel(reader));
}

void PicturesHost::end_of_pixels(NodeId node, const SubpolygonReport& report, double now) {
  const auto pixels = std::exchange(pixels_of_node_[node.place()], {});
  check(report);
  const DisplayPolygon p = pictures().grid.polygon(report.subpolygon);
  const auto width = static_cast<size_t>(p.right - p.left + 1),
             height = static_cast<size_t>(p.bottom - p.top + 1);
  if (pixels.size() != width * height) throw ProtocolError("a subpolygon with pixels missing");
  std::vector<std::byte> block(3 * pixels.size());
  std::vector<bool> seen(pixels.size());
  for (const PixelResult& pixel : pixels) {
    if (pixel.x < p.left || pixel.x > p.right || pixel.y < p.top || pixel.y > p.bottom)
      throw ProtocolError("a pixel outside of its subpolygon");
    const size_t i = static_cast<size_t>(pixel.y - p.top) * width + static_cast<size_t>(pixel.x - p.left);
    if (seen[i]) throw ProtocolError("a pixel that came twice");
    seen[i] = true;
    for (size_t c = 0; c < 3; ++c) block[3 * i + c] = static_cast<std::byte>(pixel.rgb[c]);
  }
  if (keep_result(node, {report, false, block}, kPixelBytes * pixels.size(), now) && journal_.keeps_any())
    journal_.append(journal_of(file_of(report.frame)),
                    encode_block(processor_of(node), {report, false, block}));
}

void PicturesHost::check_size(const BlockResult& result) const {
  const size_t area = area_of(pictures().grid.polygon(result.report.subpolygon));
  const int passes = pictures().passes;
  if (result.pixels.size() != area * options_.image.layout.bytes)
    throw ProtocolError("a block of another size than its subpolygon");
  if (result.pass >= passes) throw ProtocolError("a pass that was not asked for");
  if (result.running.size() != (result.pass + 1 < passes ? area * options_.passes.running_bytes : 0))
    throw ProtocolError("a block with more or less to go on from than its pass");
}

bool PicturesHost::keep_result(NodeId node, const BlockResult& result, size_t bytes, double now) {
  const SubpolygonReport& report = result.report;
  check(report);
  check_size(result);
  NodeResult& node_result = result_.node(node);
  ++node_result.subpolygons;
  node_result.rays += RayCounts{report.rays, report.ray_tallies}.total();
  node_result.busy_s += static_cast<double>(report.busy_us) * 1e-6;
  result_.pixels_received += area_of(pictures().grid.polygon(report.subpolygon));
  const std::optional<ItemIndex> item = is_at_work_ ? item_of(report, result.pass) : std::nullopt;
  if (!item || !assignment_.accept(node, *item, now)) {
    ++result_.duplicates;
    return false;
  }
  const FrameIndex frame = index_of_frame_.at(report.frame);
  files_.begin(frame);
  if (!has_journal_[frame.place()]) {
    has_journal_[frame.place()] = true;
    JournalLines lines = options_.journals.lines;
    lines.emplace_back("frame", fmt::format("{}", report.frame.value()));
    const SubpolygonGrid& grid = pictures().grid;
    lines.emplace_back("columns", fmt::format("{}", grid.columns));
    lines.emplace_back("rows", fmt::format("{}", grid.rows));
    if (grid.small_height > 0) {
      lines.emplace_back("small_height", fmt::format("{}", grid.small_height));
      lines.emplace_back("small_columns", fmt::format("{}", grid.small_columns));
      lines.emplace_back("small_rows", fmt::format("{}", grid.small_rows));
    }
    journal_.begin(journal_of(file_of(report.frame)), std::move(lines));
  }
  store(result);
  result_.rays += RayCounts{report.rays, report.ray_tallies};
  show(node, result);
  FrameResult& frame_result = result_.frames[frame.place()];
  const auto subpolygons = static_cast<size_t>(pictures().items_per_step());
  if (options_.keeps_traced_by) {
    frame_result.traced_by.resize(subpolygons);
    frame_result.traced_by[report.subpolygon.place()] = node;
  }
  if (options_.keeps_costs) {
    frame_result.costs.resize(subpolygons);
    frame_result.costs[report.subpolygon.place()] = {static_cast<double>(report.busy_us) * 1e-6, bytes};
  }
  return true;
}

void PicturesHost::store(const BlockResult& result) {
  const SubpolygonReport& report = result.report;
  const FrameIndex frame = index_of_frame_.at(report.frame);
  files_.store(frame, result);
  FrameResult& frame_result = result_.frames[frame.place()];
  frame_result.sees_anything |= report.sees_anything;
  if (result.pass + 1 == pictures().passes) frame_result.not_finite += report.not_finite;
  frame_result.rays += RayCounts{report.rays, report.ray_tallies};
  result_.pixels_kept += area_of(pictures().grid.polygon(report.subpolygon));
}

void PicturesHost::show(NodeId node, const BlockResult& result) const {
  const SubpolygonReport& report = result.report;
  for (Watcher* const watcher : options_.watchers)
    watcher->see({index_of_frame_.at(report.frame), report.frame, node,
                  pictures().grid.polygon(report.subpolygon), result.pixels});
}

void PicturesHost::tell_what_is_odd(const FrameResult& frame) const {
  if (frame.not_finite > 0)
    tell_(
        fmt::format("frame {}: {} pixels are infinite or not a number; the scene asks for light beyond all "
                    "bounds",
                    frame.frame.value(), frame.not_finite));
  if (!frame.is_black && frame.sees_anything) return;
  const Image& image = options_.image;
  if (!frame.sees_anything && image.window != PixelRect{0, 0, image.width_px, image.height_px})
    tell_(fmt::format("frame {}: no object is seen in the part that --crop asks for", frame.frame.value()));
  else if (!frame.sees_anything)
    tell_(
        fmt::format("frame {}: the camera sees nothing of the scene; check the view's location and "
                    "direction (rayfarm info prints the scene's bounds)",
                    frame.frame.value()));
  else
    tell_(
        fmt::format("frame {}: every pixel is black: no light reaches what the camera sees; rayfarm check "
                    "names lights that can't shine",
                    frame.frame.value()));
}

void PicturesHost::take_written(double now) {
  for (const FrameIndex index : files_.take_written()) {
    const FrameResult& frame = result_.frames[index.place()];
    if (frame.is_written) {
      journal_.remove(journal_of(frame.file));
      tell_what_is_odd(frame);
    }
    // None of an earlier phase is left: that was over when all were written.
    const FrameIndex of_phase(index.value() - pictures().first.value());
    const StepIndex step = pictures().step_of(of_phase, pictures().passes - 1);
    if (!frame.is_written) assignment_.abandon(step, now);
    release(step, now);
  }
  if (is_at_work_ && options_.is_streamed()) assignment_.allow_before(end_of_room(), now);
  for (const std::string& problem : journal_.take_problems()) tell_(problem);
}

void PicturesHost::finish(double now, bool with_previews) {
  files_.finish();
  take_written(now);
  journal_.sync();
  for (const std::string& problem : journal_.take_problems()) tell_(problem);
  tell_of_unfinished(with_previews);
}

void PicturesHost::tell_of_unfinished(bool with_previews) {
  for (FrameIndex i; i.place() < result_.frames.size(); ++i) {
    const FrameResult& of = result_.frames[i.place()];
    if (files_.pixels_there(i) == 0 || of.is_written) continue;
    UnfinishedFrame unfinished{of.frame,
                               files_.share_there(i),
                               journal_.is_whole(journal_of(of.file)) ? journal_of(of.file) : "",
                               {}};
    if (with_previews) {
      try {
        unfinished.preview = files_.write_preview(i);
      } catch (const std::exception& e) {
        tell_(fmt::format("there is no preview of frame {}: {}", of.frame.value(), e.what()));
      }
    }
    result_.unfinished.push_back(std::move(unfinished));
  }
}

}  // namespace rayfarm
