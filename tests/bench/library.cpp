// What a part file saves: a scene whose mesh is read from OBJ and built, against the same from a file of
// compiled objects (thesis 4.2.2). In turn in one run; wall time from the name to the compiled block.
#include <benchmark/benchmark.h>

#include <chrono>
#include <filesystem>
#include <fstream>

#include "common/compile/compile.h"
#include "common/description/part_file.h"

namespace {

using namespace rayfarm;

/// A wavy sheet of 2 n² triangles.
void write_mesh(const std::string& path, int n) {
  std::ofstream out(path);
  for (int y = 0; y <= n; ++y)
    for (int x = 0; x <= n; ++x)
      out << "v " << x << ' ' << y << ' ' << 0.002 * ((x * 7 + y * 13) % 101) << '\n';
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const int a = y * (n + 1) + x + 1, b = a + n + 1;
      out << "f " << a << ' ' << a + 1 << ' ' << b + 1 << "\nf " << a << ' ' << b + 1 << ' ' << b << '\n';
    }
}

double seconds_of(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void load_against_build(benchmark::State& state) {
  const auto folder = std::filesystem::temp_directory_path() / "rayfarm-bench-library";
  std::filesystem::create_directories(folder);
  const auto side = static_cast<int>(std::lround(std::sqrt(static_cast<double>(state.range(0)) / 2)));
  write_mesh(folder / "mesh.obj", side);
  const std::string view = "view: {location: [0, 0, 9], look_at: [0, 0, 0]}\n";
  std::ofstream(folder / "part.yaml") << "scene: [{mesh: {file: mesh.obj}}]\n";
  std::ofstream(folder / "inline.yaml") << view << "objects: {part: [{mesh: {file: mesh.obj}}]}\n"
                                        << "scene: [{use: part, transform: {translate: [1, 0, 0]}}]\n";
  std::ofstream(folder / "library.yaml")
      << view << "scene: [{use: {file: part.rfp}, transform: {translate: [1, 0, 0]}}]\n";
  write_part_file(folder / "part.rfp", compile(load_scene(folder / "part.yaml"), {}, Purpose::library).block,
                  folder / "part.yaml");
  double read_s = 0, build_s = 0, library_s = 0;
  for (auto _ : state) {
    SceneDescription described;
    read_s += seconds_of([&] { described = load_scene(folder / "inline.yaml"); });
    build_s += seconds_of([&] { benchmark::DoNotOptimize(compile(described)); });
    library_s += seconds_of([&] { benchmark::DoNotOptimize(compile(load_scene(folder / "library.yaml"))); });
  }
  const auto runs = static_cast<double>(state.iterations());
  state.counters["read_s"] = read_s / runs;
  state.counters["build_s"] = build_s / runs;
  state.counters["library_s"] = library_s / runs;
  state.counters["ratio"] = (read_s + build_s) / library_s;
  state.counters["build_ratio"] = build_s / library_s;
  state.counters["file_bytes"] = static_cast<double>(std::filesystem::file_size(folder / "part.rfp"));
  std::filesystem::remove_all(folder);
}
BENCHMARK(load_against_build)->Arg(10000)->Arg(1000000)->Iterations(5)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
