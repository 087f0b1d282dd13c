// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/laminate/laminate_commands.h"

namespace voxtone::cli {

Verb laminate_verb() {
    Verb command("laminate", "Laminates that show how light is wanted to spread in a surface",
                 "search wanted.json --materials W,K -o found");
    command.steps = {laminate_dataset_verb(), laminate_factor_verb(),  laminate_predict_verb(), laminate_print_verb(),
                     laminate_search_verb(),  laminate_targets_verb(), laminate_trace_verb()};
    return command;
}

}  // namespace voxtone::cli
