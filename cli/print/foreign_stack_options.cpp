// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/print/foreign_stack_options.h"

#include "cli/program/common_options.h"

namespace voxtone::cli {

void add_foreign_stack_options(Verb& command, std::string& resins, std::vector<std::string>& assign, bool& nearest,
                               std::string& printer, std::string& pitch) {
    command.group("Resins and foreign stacks");

    add_resins_option(command, resins, "; empty: that of the job, else that of --printer, else vero-opaque");
    command.add("--assign", assign,
                "foreign stacks: which colour is which resin: \"#00aeef=C,#ec008c=M\"; none: no material",
                {.unit = "LIST", .one_each = true, .separator = ','});
    command.add("--nearest", nearest,
                "foreign stacks with smoothed edges: a colour that stands for no resin is taken for the "
                "nearest one of --assign, and what is less than half opaque for no material");
    command.add("--printer", printer,
                "foreign stacks: voxel size of this printer (`voxtone list printers`), and how its bitmaps lie "
                "(flip_x, flip_y, swap_xy of its profile)",
                {.unit = "ID|FILE"});
    command.add("--pitch", pitch, "foreign stacks: voxel size along columns, rows, layers: 42.33,84.67,27um",
                {.unit = "X,Y,Z"});
}

}  // namespace voxtone::cli
