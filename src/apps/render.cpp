// imbibe render RUN: pictures and film of a run, from the files in its folder.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <memory>

#include "apps/commands.h"
#include "imbibe/core/error.h"
#include "imbibe/core/parallel.h"
#include "imbibe/scene/builder.h"
#include "imbibe/scene/library.h"
#include "imbibe/scene/scene.h"
#include "imbibe/view/run_frames.h"
#include "imbibe/view/run_pictures.h"

namespace {

using namespace imbibe;
namespace fs = std::filesystem;

struct RenderArguments {
  std::string folder, output, style, view;
  std::vector<std::string> sets;
  std::vector<int> size;
  int samples = 0, every = 1, frame = -1, threads = 0;
  bool last = false, no_film = false;
};

PictureOptions options_of(const RenderArguments& a, const Scene& scene) {
  PictureOptions options = scene.picture;
  if (a.style == "diagram") options.style = PictureStyle::diagram;
  if (a.style == "natural") options.style = PictureStyle::natural;
  if (a.view == "three_quarter") options.camera.view = PictureView::three_quarter;
  if (a.view == "top") options.camera.view = PictureView::top;
  if (a.view == "side") options.camera.view = PictureView::side;
  if (a.samples > 0) options.samples = a.samples;
  if (a.size.size() == 2) options.width = a.size[0], options.height = a.size[1];
  if (a.no_film) options.film = false;
  return options;
}

// Numbers of the outputs to draw.
std::vector<std::size_t> chosen_frames(const RenderArguments& a, std::size_t count) {
  if (a.last) return {count - 1};
  if (a.frame >= 0) {
    if (static_cast<std::size_t>(a.frame) >= count)
      throw InputError(fmt::format("--frame {}: the run has outputs 0 to {}", a.frame, count - 1));
    return {static_cast<std::size_t>(a.frame)};
  }
  std::vector<std::size_t> frames;
  for (std::size_t i = 0; i < count; i += static_cast<std::size_t>(a.every)) frames.push_back(i);
  return frames;
}

void render(const RenderArguments& a, const CommandContext& context) {
  const fs::path folder = a.folder, scene_file = folder / "scene.yaml";
  if (!fs::is_directory(folder)) throw InputError(fmt::format("{}: there is no such run folder", a.folder));
  if (!fs::exists(scene_file)) throw InputError(fmt::format("{}: not a run folder: it has no scene.yaml", a.folder));
  std::unique_ptr<ThreadLimit> limit;
  if (a.threads > 0) limit = std::make_unique<ThreadLimit>(a.threads);
  const Scene scene = read_scene(scene_file, a.sets);
  const World world = build_world(scene, read_library(library_folders(scene_file, context.data_folders)));
  const RunFrames run = open_run_frames(folder, world, scene.title);
  const std::vector<std::size_t> frames = chosen_frames(a, run.times.size());
  PictureOptions options = options_of(a, scene);
  if (frames.size() == 1) options.film = false;

  const fs::path output = a.output.empty() ? folder : fs::path(a.output);
  fs::create_directories(output);
  // The stage is that of the run's first output, as it was while the run went on: the same pictures come again.
  RunPictures pictures(output, options, stage_for(read_frame(run, 0), options));
  for (const std::size_t number : frames) {
    const fs::path path = pictures.add(read_frame(run, number), static_cast<int>(number));
    fmt::print(stderr, "t = {:.6g} s  {}\n", run.times[number], path.string());
  }
  fmt::print("  pictures    {}\n", (output / "pictures").string());
  if (options.film) fmt::print("  film        {}\n", pictures.finish().message);
}

}  // namespace

void add_render_command(CLI::App& app, CommandContext& context) {
  auto a = std::make_shared<RenderArguments>();
  CLI::App* command = app.add_subcommand("render", "pictures and film of a run folder");
  command->add_option("run", a->folder, "run folder")->required();
  command->add_option("-o,--output", a->output, "folder for pictures/ and film.mp4; default: the run folder");
  command->add_option("--style", a->style, "diagram | natural")->check(CLI::IsMember({"diagram", "natural"}));
  command->add_option("--view", a->view, "three_quarter | top | side")
      ->check(CLI::IsMember({"three_quarter", "top", "side"}));
  command->add_option("--size", a->size, "width and height, px")->expected(2)->check(CLI::Range(64, 8192));
  command->add_option("--samples", a->samples, "rays per pixel")->check(CLI::Range(1, 4096));
  command->add_option("--frame", a->frame, "only this output, counted from 0")->check(CLI::NonNegativeNumber);
  command->add_flag("--last", a->last, "only the last output");
  command->add_option("--every", a->every, "only every so many outputs")->check(CLI::PositiveNumber);
  command->add_option("--set", a->sets, "path=value: change a key of the scene, e.g. picture.camera.zoom=2")
      ->allow_extra_args(false);
  command->add_option("--threads", a->threads, "0 = all cores; pictures do not depend on it")->check(CLI::Range(0, 1024));
  command->add_flag("--no-film", a->no_film, "pictures only");
  command->callback([a, &context] { render(*a, context); });
}
