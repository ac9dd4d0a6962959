#include "host/render/reception.h"

#include <chrono>
#include <future>

#include "common/description/open_objects.h"
#include "protocol/clock.h"

namespace rayfarm {
namespace {

/// A scene with so many primitives takes long enough to build that its progress is shown.
constexpr uint64_t kBigScene = 200'000;

/// Reading that takes longer is shown.
constexpr double kLongReading_s = 1;

/// A scene that is being loaded by another thread; stops it when it is no longer wanted.
class SceneLoading {
 public:
  explicit SceneLoading(const RenderOptions& options)
      : future_(std::async(std::launch::async | std::launch::deferred, load, options, &reading_, &building_,
                           stop_.get_token())) {}
  ~SceneLoading() { stop_.request_stop(); }
  SceneLoading(const SceneLoading&) = delete;
  SceneLoading& operator=(const SceneLoading&) = delete;

  /// Also if the system refuses a thread: then `take` loads.
  bool is_ready() const { return future_.wait_for(std::chrono::seconds(0)) != std::future_status::timeout; }
  /// Once, when it is ready. Throws what loading threw.
  LoadedScene take() { return future_.get(); }
  const ReadProgress& reading() const { return reading_; }
  const BuildProgress& building() const { return building_; }

 private:
  static LoadedScene load(const RenderOptions& options, ReadProgress* reading, BuildProgress* building,
                          std::stop_token stop) {
    LoadedScene loaded;
    const double begin = now_s();
    LoadOptions how = options.load;
    how.stop = stop;
    how.progress = reading;
    loaded.description = load_scene(options.scene, how);
    loaded.load_s = now_s() - begin;
    loaded.options = options.adopt ? options.adopt(loaded.description) : options;
    loaded.options.adopt = options.adopt;  // it was asked
    BuildOptions build = loaded.options.build;
    build.progress = building;
    build.stop = std::move(stop);
    if (loaded.options.settings.self_hit == SelfHit::medium)
      loaded.open_objects = find_open_objects(loaded.description);
    loaded.compiled = compile_away(loaded.description, build);
    for (ObjectDescription& object : loaded.description.objects) object.primitives = {};  // they are compiled
    loaded.build_s = now_s() - begin - loaded.load_s;
    return loaded;
  }

  ReadProgress reading_;
  BuildProgress building_;
  std::stop_source stop_;
  std::future<LoadedScene> future_;  // last: its end waits for the thread
};

}  // namespace

LoadedScene load_while_nodes_report(const RenderOptions& options, RollCall& roll_call) {
  SceneLoading loading(options);
  Progress progress(options.is_quiet ? ProgressStyle::none : options.progress);
  std::optional<LoadedScene> loaded;
  const double begin = now_s();
  Backoff backoff;
  while (!loaded || !roll_call.all_reported()) {
    if (!loaded && loading.is_ready()) loaded = loading.take();
    roll_call.serve();
    const double since_s = now_s() - begin;
    const BuildProgress& building = loading.building();
    if (building.total >= kBigScene) {
      progress.show_building(since_s, building.done, building.total);
    } else if (!loaded && building.total == 0 && since_s > kLongReading_s) {
      progress.show_bytes("reading", since_s, loading.reading().done, loading.reading().total);
    }
    backoff.wait();
  }
  progress.clear();
  return std::move(*loaded);
}

}  // namespace rayfarm
