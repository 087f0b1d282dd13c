// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/cancel_on_signal.h"
#include "cli/batch/batch_commands.h"
#include "cli/calibrate/calibrate_program.h"
#include "cli/laminate/laminate_commands.h"
#include "cli/print/print_commands.h"
#include "cli/program/program.h"
#include "scattering/print/layered_profiles.h"

int main(int argc, char** argv) {
    using namespace voxtone::cli;
    voxtone::catch_stop_signals();
    voxtone::scattering::register_layered_profiles();
    const Words words = command_words(argc, argv);
    const auto add_calibrate = [&](CLI::App& app) { return add_calibrate_elsewhere(app, argv[0], words); };
    const auto add_compare = [&](CLI::App& app) { return add_compare_elsewhere(app, argv[0], words); };
    return run_program(words, {{"slice", add_slice_command},
                               {"tray", add_tray_command},
                               {"read", add_read_command},
                               {"estimate", add_estimate_command},
                               {"merge", add_merge_command},
                               {"predict", add_predict_command},
                               {"proof", add_proof_command},
                               {"compare", add_compare},
                               {"verify", add_verify_command},
                               {"target", add_target_command},
                               {"batch", add_batch_command},
                               {"status", add_status_command},
                               {"serve", add_serve_command},
                               {"task", add_task_command},
                               {"calibrate", add_calibrate},
                               {"laminate", add_laminate_command, "stack"},
                               {"list", add_list_command}});
}
