// What journals of an earlier run bring, frame by frame as each begins.
#include <fmt/core.h>

#include <utility>

#include "common/errors/input_error.h"
#include "host/farm/pictures_host.h"
#include "host/process/interrupt.h"
#include "protocol/block_codec.h"

namespace rayfarm {

void PicturesHost::resume(FrameIndex frame, const JournalHead& head) {
  const std::string path = journal_of(options_.files[frame.place()]);
  files_.begin(frame);
  const ItemIndex first = first_item_of(frame);
  std::vector<bool>& has_come = resumed_[frame];
  has_come.resize(static_cast<size_t>(pictures().items_per_step()) * static_cast<size_t>(pictures().passes));
  const auto turn = [this] { transport_.take_turn(); };
  bool is_stopped = false;
  uint64_t without_room = 0;  // pixels
  const auto take = [&](std::span<const std::byte> record) {
    turn();
    is_stopped |= interrupted_by() != 0;
    if (is_stopped) return;
    try {
      BlockResult block = decode_block(record);
      check(block.report);
      const std::optional<ItemIndex> item = item_of(block.report, block.pass);
      if (!item || of_job(pictures().step_of(*item)) != frame) return;
      const auto place = static_cast<size_t>(item->value() - first.value());
      // A pass goes on from the one before, of which the disk may have been too slow to keep the result.
      const auto step = static_cast<size_t>(pictures().items_per_step());
      if (has_come[place] || (block.pass > 0 && !has_come[place - step])) return;
      const DisplayPolygon p = pictures().grid.polygon(block.report.subpolygon);
      if (!files_.comes_to_have_room(frame, block.report.subpolygon, turn)) {
        without_room += area_of(p);
        return;
      }
      Bytes unpacked;
      if (block.is_compressed) {
        unpacked = decompress_rgb8(block.pixels, p.right - p.left + 1, p.bottom - p.top + 1);
        block.pixels = unpacked;
      }
      check_size(block);
      store(block);
      has_come[place] = true;
      show(NodeId(), block);
    } catch (const ProtocolError&) {  // whole, but no result of this frame: it is traced again
    }
  };
  try {
    uint64_t end = 0;
    // A picture that is larger than its memory may take more of it when what came before has left.
    for (uint64_t before = 1;
         files_.pixels_there(frame) != std::exchange(before, files_.pixels_there(frame)) && !is_stopped;) {
      without_room = 0;
      end = read_journal(path, head, take);
      if (without_room == 0) break;
    }
    is_stopped ? journal_.leave(path) : journal_.go_on(path, end);
  } catch (const IoError& e) {
    journal_.leave(path);
    tell_(fmt::format("frame {}: {}; what was not read of it is traced again",
                      options_.plan.pictures.frames[frame.place()].value(), e.what()));
  }
  if (without_room > 0 && !is_stopped)
    tell_(fmt::format(
        "frame {}: {:.1f} % of its pixels are in the journal, but there is no memory for them as long as "
        "others above them are missing (--frame-memory); they are traced again",
        options_.plan.pictures.frames[frame.place()].value(),
        100 * static_cast<double>(without_room) / static_cast<double>(options_.image.window.area())));
  has_journal_[frame.place()] = true;
  result_.pixels_resumed += files_.pixels_there(frame);
  result_.frames[frame.place()].is_resumed = files_.pixels_there(frame) > 0;
}

ItemIndex PicturesHost::first_item_of(FrameIndex frame) const {
  return pictures().item_of(pictures().step_of(FrameIndex(frame.value() - pictures().first.value()), 0),
                            SubpolygonId());
}

bool PicturesHost::needs_no_work(ItemIndex item) {
  if (!is_at_work_) return false;  // nobody will ask for it
  const FrameIndex frame = of_job(pictures().step_of(item));
  // Of a frame that failed in an earlier pass there is nothing to go on from.
  if (!result_.frames[frame.place()].problem.empty()) return true;
  const auto found = options_.journals.found.find(frame);
  if (found == options_.journals.found.end()) return false;
  if (!resumed_.contains(frame)) resume(frame, found->second);
  return resumed_[frame][static_cast<size_t>(item.value() - first_item_of(frame).value())];
}

}  // namespace rayfarm
