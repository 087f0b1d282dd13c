// SPDX-License-Identifier: GPL-3.0-or-later
//
// HOW-TO-PRINT.html: the page for who stands at the printer, beside what its computer takes
// (io/printer/printer_folder.h). It says what the printer's profile says, for this stack: which program, mode and
// pitch, which colour is which resin, mirrors, support, and where support leaves the print matt. It asks for nothing
// from outside, and the same stack has the same page. The manifest is in it.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "io/layers/layer_stack_writer.h"
#include "io/pictures/picture_writer.h"
#include "slicer/printer/printer.h"

namespace voxtone::slicer {

/// How much of a part's surface lies on support, or on the tray, which leaves it matt where the rest is glossy.
struct PartFinish {
    std::string name;
    int copies = 1;
    double surface_mm2 = 0, coloured_mm2 = 0;             ///< of one copy; coloured: not white
    double matt_mm2 = 0, coloured_matt_mm2 = 0;           ///< of these on support, in the mean of the copies
    double coloured_down_mm2 = 0;                         ///< of the coloured matt ones what lies downward
    std::array<double, 2> coloured_matt_height_mm{0, 0};  ///< above the tray, of nine tenths of them
};

/// The print from above, as it lies on the tray: the model's frame, square pixels.
struct PictureFromAbove {
    io::Picture8 picture;
    std::string caption;
};
/// What is told of a column of the print by its highest layer that holds resin.
using ColourOfColumn = std::function<io::Rgb(std::uint32_t i, std::uint32_t j, std::uint16_t top)>;
/// Each pixel shows the highest of its columns; 480 px at most on a side. `topmost`: of the bitmaps as they are
/// written.
[[nodiscard]] PictureFromAbove picture_from_above(const io::StackDescription& stack, const io::TopmostLayers& topmost,
                                                  const ColourOfColumn& colour, std::string caption);

/// The bitmaps' index of a voxel's column that is (i, j) in the model's frame.
[[nodiscard]] std::size_t pixel_of_column(const io::StackDescription& stack, std::uint32_t i, std::uint32_t j);

struct HowToPrint {
    std::string title;  ///< what is printed
    io::StackOutputs outputs;
    std::vector<PartFinish> parts;  ///< empty: nothing is known of surfaces
    PictureFromAbove from_above;
    std::vector<std::string> remarks{};  ///< how it is read once it is printed
    std::vector<std::string> missing{};  ///< parts that were to be in it and failed
    std::vector<std::string> fragile{};  ///< what may break when the support is washed off: and whose
};

/// `stack`: as its manifest describes it. `printer`: whose id it has.
[[nodiscard]] std::string how_to_print_page(const io::StackDescription& stack, const PrinterProfile& printer,
                                            const HowToPrint& what);

}  // namespace voxtone::slicer
