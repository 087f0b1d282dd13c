// SPDX-License-Identifier: GPL-3.0-or-later
//
// Down to which size the type of a printed picture can be read.
//
// Letters are what stands in rows (type_rows.h). Their size is that of the face, 1/0.72 of the height of capitals,
// which is the 80th percentile of the heights in the row: 1 pt = 0.3528 mm. Letters that have run together in the
// target are as high as their line.
//
// A letter is read where the contrast (a - b) / (a + b) of luminance, of the letter against what lies within 0.5 mm of
// it, is a half or more (ISO 9241-303 asks for as much of characters), or, where less was asked for, at least 0.6 of
// that; and where its x-height, half of the face, is five minutes of arc from the viewing distance, which is what
// normal sight reads (Snellen). Of less contrast c, down to a tenth, larger letters are still read, if slower: they are
// pale. Size and contrast at which reading slows down are a straight line in logarithms (Fujita et al. 2020,
// doi:10.1016/j.visres.2019.09.010); through five minutes at 0.5 and capitals of a quarter of a degree at 0.1 (Legge,
// Rubin, Luebker 1987) it is 5' (0.5 / c)^0.455. The size below which type cannot be read is the one that divides those
// that are read from those that are not with the fewest on the wrong side. What it cannot see: faces of other
// proportions, and what type_rows.h does not.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "slicer/colour/job_prediction.h"
#include "slicer/colour/slab_picture.h"

namespace voxtone::slicer {

struct TypeSize {
    double below_mm = 0;  ///< size of the face: what is smaller cannot be read; 0: all can, some is pale
    double smallest_mm = 0, largest_mm = 0;
    std::size_t letters = 0, unread = 0, pale = 0;
    double pale_contrast = 0;                 ///< mean of those that are pale
    double told_mm2 = 0;                      ///< of those that cannot be read, or where there are none are pale
    double contrast = 0, contrast_asked = 0;  ///< their means
    std::uint32_t cell = 0;                   ///< of one of them, of its ink
    Eigen::Vector3f asked = Eigen::Vector3f::Zero();  ///< linear sRGB, there
};

/// Letters of this contrast and face, from this distance, as above.
enum class Legibility : std::uint8_t { lost, pale, well };
[[nodiscard]] Legibility legibility_of(double contrast, double contrast_asked, double size_mm,
                                       double viewing_distance_mm);

/// Nothing where there is no type, or all of it is read well. `pages`: of a slab, the picture as it was given
/// (slab_picture.h), whose letters are found however small they are printed; none: those of the target alone.
[[nodiscard]] std::optional<TypeSize> unreadable_type(const JobPrediction& prediction, double viewing_distance_mm,
                                                      std::span<const PicturePage> pages = {});

/// Lines side by side, or other detail on a ground, that are no letters and run together. With t and q how far a cell's
/// lightness (Oklab) is from the mean of those within half a millimetre, of target and print, a piece keeps sum t q /
/// sum t^2, and is lost below 0.6: a line 0.1 mm wide is, a spot of a millimetre is not, however its edge is blurred.
/// Nor is what keeps half of the contrast that was asked for against what lies within 0.5 mm of it: short words, which
/// are no rows. The half was chosen on a sign of 40 mm whose type of 2 mm is legible, at 0.46 to 0.7 of it.
/// It counts what the eye at its distance may not resolve, too: who sets such lines means to see them.
struct LostLines {
    std::vector<std::uint32_t> cells;
    std::uint32_t worst = 0;                          ///< a cell of the piece that keeps least
    Eigen::Vector3f asked = Eigen::Vector3f::Zero();  ///< linear sRGB, there
    double area_mm2 = 0, kept = 0;
};
/// Of a picture's slab; nothing where that is less than 1 mm2, or than 0.1 mm2 of what keeps less than 0.3: three
/// letters of 3 points. `pages`: as above; what a coarse target does not show is lost as well.
[[nodiscard]] std::optional<LostLines> lost_lines(const JobPrediction& prediction,
                                                  std::span<const PicturePage> pages = {});

/// "2.1 mm (6 pt)".
[[nodiscard]] std::string type_size_text(double mm);

}  // namespace voxtone::slicer
