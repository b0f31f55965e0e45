// The command line: arguments to the structs of commands.h.
#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>

#include "app/commands.h"

namespace {

using namespace sutura::app;

void add_plugin_path(CLI::App& command, std::vector<std::string>& directories) {
  command.add_option("--plugin-path", directories, "Folder searched for plugins before the others")
      ->type_name("DIR")
      ->expected(1)
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

void add_scene(CLI::App& command, SceneArguments& arguments) {
  command.add_option("scene", arguments.scene, "The scene, an XML file")
      ->type_name("SCENE")
      ->required();
  command
      .add_option("--set", arguments.settings,
                  "Replaces an attribute: /skin/tissue.young=\"30 kPa\", .dt=\"5 ms\"; repeatable")
      ->type_name("PATH=VALUE")
      ->expected(1)
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command.add_flag("--allow-outside", arguments.allow_outside,
                   "Lets the scene write files outside of the output folder");
  add_plugin_path(command, arguments.plugin_directories);
}

/// What was printed may still wait to be written, and the disk be full.
int flushed(int code) {
  errno = 0;
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  complain(std::string("cannot write to the standard output: ") +
           std::strerror(errno != 0 ? errno : EIO));
  return code == ok ? static_cast<int>(sutura::Category::file) : code;
}

int dispatch(int argc, char** argv) {
  CLI::App app("Interactive simulation of surgical suturing", "sutura");
  app.set_version_flag("--version", "sutura " SUTURA_VERSION);
  app.require_subcommand(1);

  RunArguments run_arguments;
  CLI::App* run_command = app.add_subcommand("run", "Runs a scene and prints a summary");
  add_scene(*run_command, run_arguments.scene);
  CLI::Option* steps =
      run_command->add_option("--steps", run_arguments.steps, "Number of time steps")
          ->type_name("N")
          ->check(CLI::Range(sutura::Index{1}, sutura::Index{1000000000}));
  run_command
      ->add_option("--duration", run_arguments.duration,
                   "Simulated time, as in \"4 s\"; without it the duration that the scene gives")
      ->type_name("TIME")
      ->excludes(steps);
  run_command->add_option("--output", run_arguments.output, "Folder for results; default: out/NAME")
      ->type_name("DIR");

  run_command
      ->add_option("--checkpoint-every", run_arguments.checkpoint_every,
                   "Simulated time between two states written to checkpoint.sutura in the folder "
                   "for results, each in place of the one before")
      ->type_name("TIME");
  run_command
      ->add_option("--resume", run_arguments.resume,
                   "Goes on from such a state; recorded files are cut back to its step")
      ->type_name("FILE");

  run_command->add_flag("--lenient", run_arguments.lenient,
                        "Ends with 0 also where steps miss their tolerances or have faults");

  SceneArguments check_arguments;
  CLI::App* check_command =
      app.add_subcommand("check", "Reads a scene and its files and lists every error");
  add_scene(*check_command, check_arguments);

  DescribeArguments describe_arguments;
  CLI::App* describe_command =
      app.add_subcommand("describe", "Prints what a scene may contain, from all plugins found");
  describe_command->add_option("component", describe_arguments.component, "Only this component")
      ->type_name("COMPONENT");
  CLI::Option* xsd = describe_command->add_flag("--xsd", describe_arguments.xsd,
                                                "Prints an XML schema that validates scenes");
  describe_command
      ->add_option("--markdown", describe_arguments.markdown, "Writes one page per component")
      ->type_name("DIR")
      ->excludes(xsd);
  describe_command
      ->add_option("--scenes", describe_arguments.scenes,
                   "Folder of the NAME.xml that the pages show as examples")
      ->type_name("DIR")
      ->capture_default_str();
  describe_command
      ->add_flag("--devices", describe_arguments.devices,
                 "Prints the devices of this machine that plugins can use")
      ->excludes(xsd);
  add_plugin_path(*describe_command, describe_arguments.plugin_directories);

  FmuArguments fmu_arguments;
  CLI::App* fmu_command = app.add_subcommand(
      "fmu", "Packs a scene with all that it needs into an FMU (FMI 3.0, co-simulation)");
  add_scene(*fmu_command, fmu_arguments.scene);
  fmu_command
      ->add_option("--output", fmu_arguments.output, "The file to write; default: NAME.fmu here")
      ->type_name("FILE");

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? ok : usage;
  }
  if (run_command->parsed()) return run(run_arguments);
  if (check_command->parsed()) return check(check_arguments);
  if (fmu_command->parsed()) return fmu(fmu_arguments);
  return describe(describe_arguments);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return flushed(dispatch(argc, argv));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "sutura: internal error: %s\n", error.what());
  } catch (...) {
    std::fprintf(stderr, "sutura: internal error\n");
  }
  return internal;
}
