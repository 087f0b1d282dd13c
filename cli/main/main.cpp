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
    return run_program(
        words, {slice_verb(), tray_verb(), read_verb(), estimate_verb(), merge_verb(), predict_verb(), proof_verb(),
                compare_elsewhere(argv[0], words), verify_verb(), target_verb(), batch_verb(), status_verb(),
                serve_verb(), task_verb(), calibrate_elsewhere(argv[0], words), laminate_verb(), list_verb()});
}
