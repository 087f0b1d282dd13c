// SPDX-License-Identifier: GPL-3.0-or-later
//
// Down to which size the type of a printed picture can be read.
//
// Letters are what stands in rows (type_rows.h). Their size is that of the face, 1/0.72 of the height of capitals,
// which is the 80th percentile of the heights in the row: 1 pt = 0.3528 mm. Letters that have run together in the
// target are as high as their line.
//
// Normal sight reads a letter whose x-height, half of the face, is five minutes of arc times 10^a from the viewing
// distance, a its acuity at the letter's contrast: -0.08, 0.03, 0.13, 0.26 where it lacks all, 0.4, 0.2, 0.1 of the
// light of what lies within 0.5 mm of it (Fujita et al. 2008, doi:10.1007/s10384-007-0494-6); what lacks less is lost.
// It is read well where its contrast (a - b) / (a + b) is a half or more (ISO 9241-303 asks for as much of characters),
// or, where less was asked for, at least 0.6 of that; else it is pale. The size below which type cannot be read divides
// those that are read from those that are not with the fewest on the wrong side. What it cannot see: faces of other
// proportions, and what type_rows.h does not.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "slicer/colour/job_prediction.h"
#include "slicer/colour/slab_picture.h"

namespace voxtone::slicer {

struct TypeSize {
    double below_mm = 0;  ///< size of the face: what is smaller cannot be read; 0: all can, some is pale
    double smallest_mm = 0, largest_mm = 0;
    /// How much larger nine tenths of what is lost would be read, contrasts growing as sizes^1.5, up to what was
    /// asked for; 1: all is read, or no size that anybody prints would help.
    double times = 1;
    std::size_t letters = 0, unread = 0, pale = 0;
    std::vector<Eigen::AlignedBox2d>
        letters_at;                           ///< of what is told or read, in parts of the page; without `pages` none
    double pale_contrast = 0;                 ///< mean of those that are pale
    double told_mm2 = 0;                      ///< of those that cannot be read, or where there are none are pale
    double contrast = 0, contrast_asked = 0;  ///< their means
    std::uint32_t cell = 0;                   ///< of one of them, of its ink
    Eigen::Vector3f asked = Eigen::Vector3f::Zero();  ///< linear sRGB, there
    [[nodiscard]] bool is_read_well() const { return unread == 0 && pale == 0; }
};

/// Letters of this contrast and face, from this distance, as above.
enum class Legibility : std::uint8_t { lost, pale, well };
[[nodiscard]] Legibility legibility_of(double contrast, double contrast_asked, double size_mm,
                                       double viewing_distance_mm);

/// Nothing where there is no type. `pages`: of a slab, the picture as it was given
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
inline constexpr double gone_contrast = 0.3;
/// Of a picture's slab; nothing where that is less than 1 mm2, or than 0.1 mm2 of what keeps less than `gone_contrast`:
/// three letters of 3 points. `pages`: as above; what a coarse target does not show is lost as well.
[[nodiscard]] std::optional<LostLines> lost_lines(const JobPrediction& prediction,
                                                  std::span<const PicturePage> pages = {});

/// "2.1 mm (6 pt)".
[[nodiscard]] std::string type_size_text(double mm);

}  // namespace voxtone::slicer
