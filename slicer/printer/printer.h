// SPDX-License-Identifier: GPL-3.0-or-later
//
// Printer profiles: voxel size, tray, and what the printer's software accepts. A profile is a JSON file; those in
// data/printers/ are in the program, a user's own is named by its path. Keys: data/printers/README.md.
//
// A profile speaks of the bitmaps and of the tray. Where the printer wants bitmaps mirrored or swapped (`orientation`),
// a print is made in the model's frame, with the voxels and the tray as they lie there (`sliced_...`), and whoever
// writes its layers turns them (`describe`): every verb that prints gets both from here.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "io/layers/layer_format.h"
#include "io/layers/manifest.h"
#include "io/layers/rgb.h"
#include "slicer/printer/printing_time.h"

namespace voxtone::slicer {

/// A family of cartridges that a printer takes.
struct Cartridges {
    std::string family;                        ///< as resin sets name it (io::resin_family)
    std::map<std::string, std::string> names;  ///< what the printer's software calls the resin of a role
};

struct PrinterProfile {
    std::string id;                                      ///< name of the file without folder and extension
    std::string name;                                    ///< for people
    Eigen::Vector3d pitch_um = Eigen::Vector3d::Zero();  ///< voxel: column, row, layer; from dpi as 25400 / dpi
    Eigen::Vector3d tray_mm = Eigen::Vector3d::Zero();   ///< along columns, rows, layers; infinite when not given
    int max_resins = 0;                                  ///< loaded at once
    int max_colours = 0;                                 ///< of one stack, besides the background
    int min_layers = 1;
    double min_wall_mm = 0;       ///< walls that its maker asks for at least; 0: not known
    std::string min_wall_source;  ///< who says so
    io::Rgb background_rgb{};
    std::vector<io::LayerFormat> formats;               ///< written by default
    std::string default_resins;                         ///< resin set of a job that names none, or its file
    std::vector<std::string> default_roles;             ///< loaded by default; at most max_resins
    std::map<std::string, io::Rgb> colours;             ///< bitmap colour of each role
    std::vector<Cartridges> cartridges;                 ///< the usual ones first; empty: nobody said
    std::map<std::string, std::string> material_names;  ///< of the cartridges that are loaded: first the usual ones
    io::Orientation orientation;                        ///< what is done to bitmaps of the model's frame
    std::map<std::string, std::string> unconfirmed;     ///< key of the file -> why the figure is not sure
    std::string utility;                                ///< the program that takes the files, for people
    std::string mode;                                   ///< of printing, as it calls it
    HeadPasses passes{};                                ///< of the bitmaps: along their columns or rows
    std::array<double, 2> spread_mm{};                  ///< of resin before it is cured, along columns and rows
    std::vector<std::string> notes;

    /// Takes the cartridges that this set is of; nothing changes where set or printer do not say which. Those of
    /// another family have no names here, and are warned of.
    void load(const std::string& resin_set, const std::string& family);
    [[nodiscard]] bool takes(const std::string& family) const;

    /// Voxel size and largest body along the model's x, y, z: with swapped bitmaps x lies along their rows.
    [[nodiscard]] Eigen::Vector3d sliced_pitch_um() const { return as_sliced(pitch_um); }
    [[nodiscard]] Eigen::Vector3d sliced_pitch_mm() const { return sliced_pitch_um() * 1e-3; }
    [[nodiscard]] Eigen::Vector3d sliced_tray_mm() const { return as_sliced(tray_mm); }
    /// In the model's frame.
    [[nodiscard]] HeadPasses sliced_passes() const;
    [[nodiscard]] std::array<double, 2> sliced_spread_mm() const {
        return orientation.swap_xy ? std::array{spread_mm[1], spread_mm[0]} : spread_mm;
    }
    /// A stack of so many voxels along the model's x, y, z, as `io::LayerStackWriter` wants it; without resins.
    [[nodiscard]] io::StackDescription describe(const std::array<std::uint32_t, 3>& voxels) const;
    [[nodiscard]] bool confirmed(const std::string& key) const { return !unconfirmed.contains(key); }
    /// One sentence per figure that is not sure, and of cartridges that it does not take, for the user to read before
    /// printing.
    [[nodiscard]] std::vector<std::string> warnings() const;
    /// Bitmap colours of these roles, all different and none of them the background: the profile's own where it has
    /// one, else one from a fixed list. Throws InputError on more roles than colours (16).
    [[nodiscard]] std::vector<io::Rgb> display_colours(std::span<const std::string> roles) const;

private:
    std::string foreign_cartridges_;  ///< a sentence on them; empty: none
    [[nodiscard]] Eigen::Vector3d as_sliced(Eigen::Vector3d v) const {
        if (orientation.swap_xy) std::swap(v.x(), v.y());
        return v;
    }
};

/// The bitmap colour of a role where no profile says otherwise, which looks like its resin; nothing for a role of the
/// user's own.
[[nodiscard]] std::optional<io::Rgb> usual_colour(const std::string& role);

/// The JSON of a profile that comes with the program; nothing for other ids.
[[nodiscard]] std::optional<std::string_view> known_printer_text(std::string_view id);
/// A profile of the program by its id, or a file by its path (anything with a '/' or ending in ".json").
/// Throws InputError (unknown id: names the known ones; a wrong file: file, key, rule), FileError.
[[nodiscard]] PrinterProfile find_printer(const std::string& id_or_path);

/// All profiles of the program, by id.
[[nodiscard]] std::vector<PrinterProfile> list_printers();

/// A profile from its JSON text; `where` names the file in errors. Throws InputError.
[[nodiscard]] PrinterProfile parse_printer(std::string_view json, const std::string& id, const std::string& where);

}  // namespace voxtone::slicer
