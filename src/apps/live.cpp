// imbibe live: a simulation, or a finished run, on a page of this machine.
#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <random>

#include "apps/commands.h"
#include "imbibe/core/error.h"
#include "imbibe/core/parallel.h"
#include "imbibe/live/gallery.h"
#include "imbibe/live/live_stage.h"
#include "imbibe/live/replay.h"
#include "imbibe/live/server.h"

namespace fs = std::filesystem;
using namespace imbibe;

namespace {

volatile std::sig_atomic_t stop_signal = 0;
void on_signal(int number) { stop_signal = number; }

struct LiveArguments {
  std::string scene, output, listen = "127.0.0.1", token;
  std::vector<std::string> overrides;
  int port = 0, threads = 0;
  double speed = 1;
  bool overwrite = false, record = false, run_at_once = false, no_browser = false;
};

std::string new_token() {
  std::random_device source;  // the system's own
  std::string token;
  for (int i = 0; i < 8; ++i) token += fmt::format("{:08x}", source());
  return token;
}

bool is_this_machine(const std::string& address) { return address.starts_with("127."); }

// A desktop's own way to open an address; its output is thrown away.
void open_browser(const std::string& url) {
  if (!std::getenv("DISPLAY") && !std::getenv("WAYLAND_DISPLAY")) return;
  const pid_t child = fork();
  if (child != 0) return;
  const int nothing = ::open("/dev/null", O_RDWR);
  dup2(nothing, 0), dup2(nothing, 1), dup2(nothing, 2);
  execlp("xdg-open", "xdg-open", url.c_str(), static_cast<char*>(nullptr));
  _exit(127);
}

bool is_run_folder(const fs::path& path) { return fs::is_directory(path) && fs::exists(path / "run.json"); }

int go(const LiveArguments& arguments, const CommandContext& context) {
  auto page = live::read_page(context.data_folders);
  if (page.empty())
    throw InputError("the page of `imbibe live` is not built: run ./imbibe live, or in viewer/: npm install && npm run build "
                     "(needs nodejs and npm)");
  live::Server* looking = nullptr;  // set before the first feed makes its first event
  const auto wake = [&looking] {
    if (looking) looking->wake();
  };
  auto gallery = std::make_shared<live::Gallery>(live::find_gallery(context.data_folders, "runs/drafts"));
  std::unique_ptr<live::LiveStage> stage;
  std::string folder;

  // The server needs the stage and wakes it needs the server: the socket is opened first with an empty stage behind it.
  class Door final : public live::Stage {
   public:
    std::unique_ptr<live::LiveStage>* stage = nullptr;
    std::vector<std::shared_ptr<live::Feed>> feeds() override { return (*stage)->feeds(); }
    std::string hello_json() override { return (*stage)->hello_json(); }
    bool take(std::uint64_t viewer, const live::Message& message, std::vector<live::Event>& events) override {
      return (*stage)->take(viewer, message, events);
    }
  } door;
  door.stage = &stage;
  live::ServerOptions options;
  options.address = arguments.listen, options.port = arguments.port, options.token = arguments.token;
  if (options.token.empty() && !is_this_machine(options.address)) options.token = new_token();
  live::Server server(options, std::move(page), door);
  looking = &server;

  if (is_run_folder(arguments.scene)) {
    auto library = std::make_shared<Library>(
        read_library(library_folders(fs::path(arguments.scene) / "scene.yaml", context.data_folders)));
    stage = std::make_unique<live::LiveStage>(std::make_shared<live::Replay>(arguments.scene, std::move(library), wake),
                                              gallery);
  } else {
    live::SessionSetup setup;
    setup.scene = read_scene(arguments.scene, arguments.overrides);
    setup.library =
        std::make_shared<Library>(read_library(library_folders(arguments.scene, context.data_folders)));
    setup.gallery = gallery;
    setup.record.folder = arguments.output.empty() ? fs::path("runs") / (fs::path(arguments.scene).stem().string() + "_live")
                                                   : fs::path(arguments.output);
    setup.record.exactly = !arguments.output.empty();
    setup.record.overwrite = arguments.overwrite;
    setup.record.files = arguments.record;
    setup.record.command = context.command_line;
    setup.speed_limit = arguments.speed;
    setup.wait_for_viewer = !arguments.run_at_once;
    stage = std::make_unique<live::LiveStage>(std::move(setup), wake);
  }
  std::printf("the page is at  %s\n", server.url().c_str());
  if (!options.token.empty()) std::printf("whoever has this address with its token may watch and take the controls\n");
  std::printf("Ctrl-C ends it\n");
  std::fflush(stdout);
  if (!arguments.no_browser) open_browser(server.url());
  server.run([] { return stop_signal != 0; });
  stage->end();
  looking = nullptr;
  const auto& counts = server.counts();
  std::printf("%llu frames, %.3g kB each; %llu malformed messages, %llu requests refused\n",
              static_cast<unsigned long long>(counts.frames),
              counts.frames > 0 ? 1e-3 * static_cast<double>(counts.frame_bytes) / static_cast<double>(counts.frames) : 0.0,
              static_cast<unsigned long long>(counts.malformed), static_cast<unsigned long long>(counts.refused));
  return 0;
}

}  // namespace

void add_live_command(CLI::App& app, CommandContext& context) {
  auto arguments = std::make_shared<LiveArguments>();
  CLI::App* command = app.add_subcommand("live", "a scene, or a finished run, on a page of this machine");
  command->add_option("scene", arguments->scene, "scene file to simulate, or run folder to replay")->required();
  command->add_option("-o,--output", arguments->output, "run folder; default runs/<scene>_live, numbered when taken");
  command->add_option("--set", arguments->overrides, "path=value: change a key of the scene")->allow_extra_args(false);
  command->add_option("--port", arguments->port, "0: a free one")->check(CLI::Range(0, 65535));
  command->add_option("--listen", arguments->listen,
                      "IPv4 address; other than 127.0.0.1 it needs a token, which is then printed");
  command->add_option("--token", arguments->token, "the token, in place of a random one");
  command->add_option("--speed", arguments->speed, "most simulated seconds per second; 0: no limit")
      ->check(CLI::NonNegativeNumber);
  command->add_option("--threads", arguments->threads, "0 = all cores; results do not depend on it")
      ->check(CLI::Range(0, 1024));
  command->add_flag("--run", arguments->run_at_once, "start the clock at once; default: paused until a page says run");
  command->add_flag("--record", arguments->record, "write all files of a run from the start");
  command->add_flag("--overwrite", arguments->overwrite, "replace an earlier run in the folder given with -o");
  command->add_flag("--no-browser", arguments->no_browser, "do not open a browser");
  command->callback([arguments, &context] {
    std::signal(SIGINT, on_signal);
    std::signal(SIGTERM, on_signal);
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);
    std::unique_ptr<ThreadLimit> limit;
    if (arguments->threads > 0) limit = std::make_unique<ThreadLimit>(arguments->threads);
    context.exit_code = go(*arguments, context);
  });
}
