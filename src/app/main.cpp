// The program: splits the command line, owns MPI and PETSc, and is the only place that turns errors into exit codes.

#include <fmt/format.h>
#include <mpi.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <optional>
#include <string>
#include <vector>

#include "commands.hpp"
#include "whirl/core/agree.hpp"
#include "whirl/core/error.hpp"
#include "whirl/core/printable.hpp"
#include "whirl/core/session.hpp"
#include "whirl/deck/node.hpp"

namespace {

using namespace whirl;

struct CommandLine {
  std::vector<std::string> words;  // ours, reversed as the parser wants them
  std::vector<std::string> petsc;  // behind `--`
};

// True for `bearings.B1.node=3`: a path of a deck before the first sign of equality.
bool is_assignment(const std::string& word) {
  const std::size_t equals = word.find('=');
  return equals != std::string::npos && equals > 0 && word[0] != '-' && word.find('/') > equals;
}

CommandLine split(int argc, char** argv) {
  CommandLine c;
  bool ours = true, sets = false;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (ours && word == "--") {
      ours = false;
      continue;
    }
    // Several assignments may follow one `--set`; the deck may follow them.
    if (ours && sets && is_assignment(word) && std::string(argv[i - 1]) != "--set") c.words.push_back("--set");
    if (ours && word != "--set" && !is_assignment(word)) sets = false;
    if (ours && word == "--set") sets = true;
    (ours ? c.words : c.petsc).push_back(word);
  }
  std::reverse(c.words.begin(), c.words.end());
  return c;
}

std::vector<std::string> names_of_commands(const CLI::App& cli) {
  std::vector<std::string> names;
  for (const CLI::App* c : cli.get_subcommands({})) names.push_back(c->get_name());
  return names;
}

// What is wrong with the words, in our own form: the library's texts neither name the command nor guess what was meant.
std::string complaint(const CLI::App& cli, const CommandLine& line, const CLI::ParseError& e) {
  const std::vector<std::string> commands = names_of_commands(cli);
  const auto chosen = cli.get_subcommands();
  if (chosen.empty()) {
    const std::string list = fmt::format("commands are help, {}", fmt::join(commands, ", "));
    if (line.words.empty()) return "what shall be done? " + list;
    const std::string& word = line.words.back();
    const std::string hint = deck::did_you_mean(word, commands);
    return word.starts_with("-") ? fmt::format("there is no option '{}'; see whirl --help", word)
                                 : fmt::format("there is no command '{}'{}; {}", word, hint, list);
  }
  const std::string name = chosen.front()->get_name();
  std::string text = e.what();
  for (const std::string& word : cli.remaining(true)) {
    if (!word.starts_with("-") || word == "-") continue;
    std::vector<std::string> options;
    for (const CLI::Option* o : chosen.front()->get_options())
      for (const std::string& l : o->get_lnames()) options.push_back("--" + l);
    text = fmt::format("there is no option '{}'{}", word, deck::did_you_mean(word, options));
    break;
  }
  return fmt::format("{}: {}; see whirl help {}", name, text, name);
}

core::Exit dispatch(CommandLine line, bool prints) {
  CLI::App cli{"Nonlinear dynamics of rotors in fluid films", "whirl"};
  cli.set_version_flag("--version", "whirl " WHIRL_VERSION);
  cli.require_subcommand(1);
  cli.footer(
      "`whirl help COMMAND` explains a command, `whirl help KEY` an option of decks.\n"
      "Words behind `--` are options of PETSc: whirl run deck.yaml -- -newton_snes_monitor");

  app::RunRequest run;
  app::CheckRequest check;
  std::string key;
  auto deck_options = [](CLI::App* c, auto& deck, std::vector<std::string>& overrides, const char* text) {
    c->add_option("DECK", deck, text)->required();
    c->add_option("--set", overrides,
                  "PATH=VALUE...: change values. PATH may hold wildcards (bearings.{B2,B3}.geometry.clearance, "
                  "bearings.*.node); "
                  "list items count from 1. VALUE replaces (-20 um too), x1.2 and '+20 %' multiply, 'by +500 um' and "
                  "'by -20 um' "
                  "add; PATH+=VALUE appends to a list (studies+='{static: {}}')")
        ->allow_extra_args(false)
        ->type_name("PATH=VALUE");
  };
  CLI::App* run_command = cli.add_subcommand("run", "compute the studies of a deck");
  deck_options(run_command, run.deck.path, run.deck.overrides, "input deck (YAML)");
  run_command->add_option("-o,--output", run.directory, "directory of the results (results/NAME OF DECK if not given)")
      ->type_name("DIR");
  run_command->add_flag("--resume", run.resume,
                        "go on from the checkpoints in the directory, from the beginning if there are none");
  run_command->add_flag("--force", run.force, "replace results of an earlier run");
  run_command->add_flag("--progress", run.progress, "tell how far the work is");
  run_command
      ->add_option("--stop-after-checkpoint", run.stop_after_checkpoint,
                   "end as if killed once N checkpoints have been written, to try how it resumes")
      ->type_name("N")
      ->check(CLI::PositiveNumber);
  CLI::App* check_command = cli.add_subcommand("check", "check decks without computing");
  deck_options(check_command, check.paths, check.overrides, "input decks (YAML)");
  CLI::App* list_command = cli.add_subcommand("list", "list the kinds of studies");
  CLI::App* describe_command = cli.add_subcommand("describe", "explain the options of decks");
  describe_command->add_option("KEY", key, "option or group of options, such as bearings.geometry");
  CLI::App* schema_command = cli.add_subcommand("schema", "print the JSON Schema of decks, for editors");

  // `help`, `help COMMAND` and `help KEY` are other words for what there is.
  if (!line.words.empty() && line.words.back() == "help") {
    const std::string about = line.words.size() > 1 ? line.words[line.words.size() - 2] : "";
    if (about.empty())
      line.words = {"--help"};
    else if (const auto known = names_of_commands(cli); std::find(known.begin(), known.end(), about) != known.end())
      line.words = {"--help", about};
    else
      line.words.back() = "describe";
  }
  try {
    cli.parse(std::vector<std::string>(line.words));
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() != 0) {
      core::InputError wrong(complaint(cli, line, e));
      wrong.mark_agreed();
      throw wrong;
    }
    if (prints) (void)cli.exit(e);
    return core::Exit::success;
  }
  std::string text;
  core::Exit exit = core::Exit::success;
  const auto print = [prints](const std::string& part) {
    if (!prints) return;
    (void)std::fputs(part.c_str(), stdout);
    (void)std::fflush(stdout);  // a file shows at once what a study of an hour has found
  };
  if (*run_command) exit = app::run(MPI_COMM_WORLD, run, print);
  if (*check_command) app::check(MPI_COMM_WORLD, check, print);
  if (*list_command) text = app::list();
  if (*describe_command) text = app::describe(key);
  if (*schema_command) text = app::schema();
  print(text);
  return exit;
}

// What explains the program needs neither ranks nor solvers, whose libraries take longer to start than it takes.
bool only_explains(const CommandLine& line) {
  static constexpr std::array words{"list", "describe", "schema", "help", "--help", "-h", "--version"};
  return !core::Session::launched() && line.petsc.empty() && !line.words.empty() &&
         std::ranges::find(words, line.words.back()) != words.end();
}

// An error that all ranks have leaves in order; one that only this rank has would leave the others waiting.
int leave(const std::string& text, core::Exit exit, bool agreed, bool prints) {
  int started = 0, size = 1, rank = 0;
  MPI_Initialized(&started);
  if (started != 0) {
    MPI_Comm_size(MPI_COMM_WORLD, &size);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  }
  const bool alone = size > 1 && !agreed;
  if (prints || alone) {
    (void)std::fflush(stdout);
    (void)std::fprintf(stderr, "whirl: %s%s\n", alone ? fmt::format("rank {}: ", rank).c_str() : "",
                       core::printable(text).c_str());
    (void)std::fflush(stderr);
  }
  if (alone) MPI_Abort(MPI_COMM_WORLD, static_cast<int>(exit));
  return static_cast<int>(exit);
}

}  // namespace

int main(int argc, char** argv) {
  CommandLine line = split(argc, argv);
  std::optional<core::Session> session;
  const bool explains = only_explains(line);
  try {
    if (!explains) session.emplace(argc, argv);
  } catch (const std::exception& e) {  // every rank reads the same files and environment
    (void)std::fprintf(stderr, "whirl: %s\n", e.what());
    (void)std::fflush(nullptr);
    // A thread of the BLAS library that waits for memory would be waited for at an orderly end.
    std::_Exit(static_cast<int>(core::Exit::failure));
  }
  int rank = 0;
  if (!explains) MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  const bool prints = rank == 0;
  try {
    if (!explains) core::Session::set_options(line.petsc);
    return static_cast<int>(dispatch(std::move(line), prints));
  } catch (const core::Error& e) {
    return leave(e.what(), e.exit(), e.agreed(), prints);
  } catch (const std::bad_alloc&) {
    return leave(core::out_of_memory, core::Exit::failure, false, prints);
  } catch (const std::exception& e) {
    return leave(fmt::format("internal error: {}", e.what()), core::Exit::bug, false, prints);
  }
}
