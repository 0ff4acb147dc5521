#include "clients/cli/commands/commands.hpp"

namespace kolsky::cli {

Command import_csv_command();
Command calibrate_command();
Command identify_bar_command();
Command identify_specimen_command();
Command plan_command();
Command reduce_command();
Command effects_command();
Command model_new_command();
Command model_add_command();
Command model_remove_command();
Command model_show_command();
Command model_history_command();
Command model_revert_command();
Command model_check_command();
Command model_diff_command();
Command model_waterfall_command();
Command fit_command();
Command compare_command();
Command diagnose_command();
Command dispersion_command();
Command selftest_command();
Command tour_command();
Command diagnose_live_command();
Command impact_command();
Command chain_command();
Command verify_command();
Command export_command();
Command status_command();
Command arm_command();
Command disarm_command();
Command fire_command();
Command force_trigger_command();
Command shots_command();
Command get_command();
Command watch_command();
Command waves_command();
Command reload_command();
Command release_command();
Command stop_command();

std::vector<Command> all_commands() {
  // One a line, so that a new one touches no other.
  // clang-format off
  return {
      import_csv_command(),
      calibrate_command(),
      identify_bar_command(),
      identify_specimen_command(),
      plan_command(),
      reduce_command(),
      waves_command(),
      dispersion_command(),
      effects_command(),
      model_new_command(),
      model_add_command(),
      model_remove_command(),
      model_show_command(),
      model_history_command(),
      model_revert_command(),
      model_check_command(),
      model_diff_command(),
      model_waterfall_command(),
      fit_command(),
      compare_command(),
      diagnose_command(),
      selftest_command(),
      tour_command(),
      diagnose_live_command(),
      impact_command(),
      chain_command(),
      verify_command(),
      export_command(),
      status_command(),
      arm_command(),
      disarm_command(),
      fire_command(),
      force_trigger_command(),
      shots_command(),
      get_command(),
      watch_command(),
      reload_command(),
      release_command(),
      stop_command(),
  };
  // clang-format on
}

}  // namespace kolsky::cli
