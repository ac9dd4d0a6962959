#include "host/render/reception.h"

#include <chrono>
#include <future>

#include "protocol/clock.h"

namespace rayfarm {
namespace {

/// A scene with so many primitives takes long enough to build that its progress is shown.
constexpr uint64_t kBigScene = 200'000;

/// A scene that is being loaded by another thread; stops it when it is no longer wanted.
class SceneLoading {
 public:
  SceneLoading(const std::string& path, const BuildOptions& build)
      : future_(std::async(std::launch::async | std::launch::deferred, load, path, build, &progress_,
                           stop_.get_token())) {}
  ~SceneLoading() { stop_.request_stop(); }
  SceneLoading(const SceneLoading&) = delete;
  SceneLoading& operator=(const SceneLoading&) = delete;

  /// Also if the system refuses a thread: then `take` loads.
  bool is_ready() const { return future_.wait_for(std::chrono::seconds(0)) != std::future_status::timeout; }
  /// Once, when it is ready. Throws what loading threw.
  LoadedScene take() { return future_.get(); }
  const BuildProgress& progress() const { return progress_; }

 private:
  static LoadedScene load(const std::string& path, BuildOptions build, BuildProgress* progress,
                          std::stop_token stop) {
    LoadedScene loaded;
    const double begin = now_s();
    loaded.description = load_scene(path, stop);
    loaded.load_s = now_s() - begin;
    build.progress = progress;
    build.stop = std::move(stop);
    loaded.compiled = compile(loaded.description, build);
    loaded.build_s = now_s() - begin - loaded.load_s;
    for (ObjectDescription& object : loaded.description.objects) object.primitives = {};  // they are compiled
    return loaded;
  }

  BuildProgress progress_;
  std::stop_source stop_;
  std::future<LoadedScene> future_;  // last: its end waits for the thread
};

}  // namespace

LoadedScene load_while_nodes_report(const RenderOptions& options, RollCall& roll_call) {
  SceneLoading loading(options.scene, options.build);
  Progress progress(options.is_quiet ? ProgressStyle::none : options.progress);
  std::optional<LoadedScene> loaded;
  const double begin = now_s();
  Backoff backoff;
  while (!loaded || !roll_call.all_reported()) {
    if (!loaded && loading.is_ready()) loaded = loading.take();
    roll_call.serve();
    const BuildProgress& building = loading.progress();
    if (building.total >= kBigScene) progress.show_building(now_s() - begin, building.done, building.total);
    backoff.wait();
  }
  progress.clear();
  return std::move(*loaded);
}

}  // namespace rayfarm
