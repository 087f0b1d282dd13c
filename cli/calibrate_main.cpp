// SPDX-License-Identifier: GPL-3.0-or-later
//
// voxtone-calibrate: what `voxtone calibrate` becomes (cli/calibrate_program.h), with the same command line.
#include "voxtone/base/cancel_on_signal.h"
#include "voxtone/cli/commands.h"
#include "voxtone/cli/program.h"

int main(int argc, char** argv) {
    using namespace voxtone::cli;
    voxtone::catch_stop_signals();
    return run_program(command_words(argc, argv), {{"calibrate", add_calibrate_command}}, false);
}
