// SPDX-License-Identifier: GPL-3.0-or-later
#include <catch2/catch.hpp>

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <fmt/core.h>

#include "base/error.h"
#include "io/files/whole_file.h"
#include "io/layers/orient.h"
#include "io/layers/stack_folder.h"
#include "io/pictures/picture_writer.h"
#include "slicer/predict/stack_volume.h"
#include "slicer/printer/printer.h"
#include "tests/io/files/temporary_folder.h"
#include "tests/io/layers/stack_samples.h"

using namespace voxtone;
using namespace voxtone::slicer;
using Catch::Matchers::Contains;

namespace {

// A body without any symmetry: 37 x 21 x 35 voxels of materials 1 to 5, a tower on its corner of small x and small y.
constexpr int nx = 37, ny = 21, nz = 35;
int marker(int x, int y, int z) {
    if (x < 0 || y < 0 || z < 0 || x >= nx || y >= ny || z >= nz) return 0;
    if (z >= 20 && (x >= 9 || y >= 5)) return 0;
    return 1 + (x / 5 + 2 * (y / 4) + 3 * (z / 6)) % 5;
}

/// Layer z of the marker in a bitmap with empty margins: `left` columns, `below` rows at small y, `around` on the other
/// sides.
io::LayerRuns marker_layer(int z, int left = 0, int below = 0, int around = 0) {
    const int width = nx + left + around, height = ny + below + around;
    std::vector<io::Material> pixels;
    for (int row = 0; row < height; ++row)
        for (int x = 0; x < width; ++x)
            pixels.push_back(static_cast<io::Material>(marker(x - left, height - 1 - row - below, z)));
    return io::layer_from_pixels(pixels, static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height));
}

void write_marker(const std::filesystem::path& out, const io::Orientation& orientation, bool gcvf = false) {
    io::StackDescription stack = io::sample_description(nz, nx, ny);
    stack.orientation = orientation;
    stack.origin_mm = {1, 2, 3};
    io::StackOutputs outputs;
    outputs.gcvf = gcvf;
    io::LayerStackWriter writer(out, stack, outputs);
    for (int z = 0; z < nz; ++z) writer.write(static_cast<std::uint32_t>(z), marker_layer(z));
    (void)writer.finish();
}

std::size_t wrong_voxels(const StackVolume& stack) {
    // Resins of the sample in their order C, M, Y, K, W; the set of the volume may have another.
    const char* const role[] = {"", "C", "M", "Y", "K", "W"};
    std::size_t wrong = 0;
    for (int z = 0; z < nz; ++z)
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x) {
                const int material = stack.volume.at(x, y, z), expected = marker(x, y, z);
                wrong += expected == 0
                             ? material != 0
                             : material == 0 ||
                                   stack.resins.resins[static_cast<std::size_t>(material - 1)].role != role[expected];
            }
    return wrong;
}

std::string message(const StackVolumeOptions& options, ExitCode code) {
    Progress progress;
    try {
        (void)read_stack_volume(options, progress);
    } catch (const Error& error) {
        CHECK(error.exit_code() == code);
        return error.what();
    }
    FAIL("no error");
    return {};
}

std::vector<ColourAssignment> assigned(const std::vector<std::string>& texts) {
    std::vector<ColourAssignment> assigned;
    for (const std::string& text : texts) assigned.push_back(parse_assignment(text));
    return assigned;
}

struct ListeningProgress final : Progress {
    std::vector<std::string> warnings, notes;
    void on_warning(const std::string& message) override { warnings.push_back(message); }
    void on_note(const std::string& message) override { notes.push_back(message); }
};

const std::vector<std::string> sample_colours{"#00aeef=C", "#ec008c=m", "#fff200=VeroYellow", "#282828=K", "#dcded8=W"};
/// Of the set that printers of Vivid cartridges take.
const std::vector<std::string> vivid_colours{"#00aeef=C", "#ec008c=m", "#fff200=VeroYellowV", "#282828=K", "#dcded8=W"};

}  // namespace

TEST_CASE("An own stack comes back in the model's frame, however its bitmaps were mirrored") {
    const io::TemporaryFolder folder;
    int count = 0;
    for (const io::Orientation o :
         {io::Orientation{}, io::Orientation{true, false, false}, io::Orientation{false, true, false},
          io::Orientation{false, false, true}, io::Orientation{true, false, true}, io::Orientation{true, true, true}}) {
        const auto out = folder.path() / std::to_string(count++);
        write_marker(out, o);
        Progress progress;
        const StackVolume stack = read_stack_volume({.stack = out.string()}, progress);
        REQUIRE(stack.volume.size() == std::array<int, 3>{nx, ny, nz});
        CHECK(stack.volume.pitch_mm()[0] == Approx(25.4 / 600));
        CHECK(stack.volume.pitch_mm()[1] == Approx(25.4 / 300));
        CHECK(stack.corner_mm == std::array<double, 3>{1, 2, 3});
        CHECK(wrong_voxels(stack) == 0);
        CHECK(stack.resins.resins[static_cast<std::size_t>(stack.white)].role == "W");
    }
}

TEST_CASE("A foreign folder is cropped to its body and has the assigned resins") {
    const io::TemporaryFolder folder;
    const io::PngLayerEncoder encoder(io::sample_description(nz).palette(), {42, 85});
    // Two empty layers below; 5 empty columns left, 3 empty rows at small y, 4 on the other sides.
    for (int z = -2; z < nz; ++z)
        io::write_whole_file(folder.path() / ("layer_" + std::to_string(z + 102) + ".png"),
                             encoder.encode(marker_layer(z, 5, 3, 4)));
    Progress progress;
    const StackVolume stack = read_stack_volume({.stack = folder.path().string(),
                                                 .pitch_mm = parse_pitch_mm("0.05,0.08,0.03mm"),
                                                 .assign = assigned(sample_colours)},
                                                progress);
    REQUIRE(stack.volume.size() == std::array<int, 3>{nx, ny, nz});
    CHECK(wrong_voxels(stack) == 0);
    CHECK(stack.volume.pitch_mm() == std::array<double, 3>{0.05, 0.08, 0.03});
    CHECK(stack.corner_mm[0] == Approx(5 * 0.05));
    CHECK(stack.corner_mm[1] == Approx(3 * 0.08));
    CHECK(stack.corner_mm[2] == Approx(2 * 0.03));
    // The printer's profile gives the pitch too.
    const StackVolume of_printer = read_stack_volume(
        {.stack = folder.path().string(), .printer = "stratasys-j750-hq", .assign = assigned(vivid_colours)}, progress);
    CHECK(of_printer.volume.pitch_mm()[2] == Approx(0.014));
    // By what the printer's computer calls a resin; another family's is refused (below).
    auto by_cartridge = vivid_colours;
    by_cartridge[0] = "#00aeef=verocy-v";
    const StackVolume named = read_stack_volume(
        {.stack = folder.path().string(), .printer = "stratasys-j750-hq", .assign = assigned(by_cartridge)}, progress);
    CHECK(wrong_voxels(named) == wrong_voxels(of_printer));
    CHECK(named.resins.resins[0].role == "C");
    // A colour that is no material leaves holes.
    auto without_cyan = vivid_colours;
    without_cyan[0] = "#00aeef=none";
    const StackVolume holes = read_stack_volume(
        {.stack = folder.path().string(), .printer = "stratasys-j750-hq", .assign = assigned(without_cyan)}, progress);
    CHECK(wrong_voxels(holes) > 1000);
}

TEST_CASE("Bitmaps of a resin printer's archive lie as its slicer's settings beside them say") {
    struct Panel {
        const char *turned, *mirror_x, *mirror_y;
        io::Orientation orientation;
    };
    int count = 0;
    const io::TemporaryFolder root;
    // By hand, of PrusaSlicer's panels: what is done to upright bitmaps, which is undone.
    for (const auto& [turned, mirror_x, mirror_y, orientation] :
         {Panel{"portrait", "1", "0", {true, true, true}}, Panel{"portrait", "0", "0", {false, true, true}},
          Panel{"portrait", "1", "1", {true, false, true}}, Panel{"landscape", "1", "0", {true, false, false}},
          Panel{"landscape", "0", "1", {false, true, false}}, Panel{"landscape", "0", "0", {}}}) {
        const auto folder = root.path() / std::to_string(count++);
        std::filesystem::create_directories(folder);
        const io::PngLayerEncoder encoder(io::sample_description(nz).palette(), {42, 85});
        for (int z = 0; z < nz; ++z)
            io::write_whole_file(folder / ("model" + std::to_string(100 + z) + ".png"),
                                 encoder.encode(io::oriented(marker_layer(z), orientation)));
        io::write_whole_file(folder / "config.ini", std::string("action = print\nlayerHeight = 0.05\n"));
        const StackVolumeOptions options{.stack = folder.string(),
                                         .pitch_mm = parse_pitch_mm("0.05,0.08,0.03mm"),
                                         .assign = assigned(sample_colours)};
        ListeningProgress as_they_lie;
        const StackVolume mirrored = read_stack_volume(options, as_they_lie);
        CHECK(as_they_lie.notes.empty());
        CHECK((orientation == io::Orientation{} || mirrored.volume.size() != std::array<int, 3>{nx, ny, nz} ||
               wrong_voxels(mirrored) > 100));
        io::write_whole_file(folder / "prusaslicer.ini",
                             fmt::format("; made by PrusaSlicer\r\ndisplay_mirror_x = {}\r\ndisplay_mirror_y = {}\r\n"
                                         "display_orientation = {}\r\n",
                                         mirror_x, mirror_y, turned));
        ListeningProgress heard;
        const StackVolume stack = read_stack_volume(options, heard);
        REQUIRE(stack.volume.size() == std::array<int, 3>{nx, ny, nz});
        CHECK(wrong_voxels(stack) == 0);
        CHECK(stack.volume.pitch_mm()[0] == (orientation.swap_xy ? 0.08 : 0.05));
        REQUIRE(heard.notes.size() == (orientation == io::Orientation{} ? 0 : 1));
        if (!heard.notes.empty()) CHECK_THAT(heard.notes[0], Contains("as it was sliced"));
    }
}

TEST_CASE("A GCVF says by its materials' names which resins it has") {
    const io::TemporaryFolder folder;
    write_marker(folder.path() / "out", {}, true);
    const auto file = folder.path() / "out" / io::gcvf_name;
    Progress progress;
    const StackVolume stack = read_stack_volume({.stack = file.string()}, progress);
    REQUIRE(stack.volume.size() == std::array<int, 3>{nx, ny, nz});
    CHECK(wrong_voxels(stack) == 0);
    CHECK(stack.volume.pitch_mm()[0] == Approx(25.4 / 600).epsilon(1e-6));
    CHECK(stack.volume.pitch_mm()[2] == Approx(0.027));
}

TEST_CASE("What is known of a stack is told before its layers are kept, and can refuse it") {
    const io::TemporaryFolder folder;
    io::Orientation turned;
    turned.swap_xy = true;
    const std::string own = (folder.path() / "own").string();
    write_marker(own, turned);
    write_marker(folder.path() / "straight", {}, true);
    std::uint64_t solid = 0;
    for (int z = 0; z < nz; ++z)
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x) solid += marker(x, y, z) != 0;
    class Stages final : public Progress {
    public:
        std::vector<std::string> begun;

    private:
        void on_stage(std::string_view name, std::uint64_t, std::string_view) override { begun.emplace_back(name); }
    } progress;
    int told = 0;
    const auto refuse = [&](const StackHead& head) {
        ++told;
        CHECK(head.size == std::array<int, 3>{nx, ny, nz});
        CHECK(head.pitch_mm[2] == Approx(0.027));
        CHECK(head.solid_voxels == solid);
        CHECK(head.resin_set == (told == 1 ? "j750-vivid" : "vero-opaque"));  // its printer's; a container names none
        CHECK(head.has_white);
        CHECK_FALSE(head.of_picture);
        throw UsageError("no");
    };
    CHECK_THROWS_AS(read_stack_volume({.stack = own, .before_reading = refuse}, progress), UsageError);
    CHECK(progress.begun.empty());
    // Where the body lies in a foreign stack, and how much of it, only its layers tell.
    const std::string gcvf = (folder.path() / "straight" / io::gcvf_name).string();
    CHECK_THROWS_AS(read_stack_volume({.stack = gcvf, .before_reading = refuse}, progress), UsageError);
    CHECK(progress.begun == std::vector<std::string>{"find the body"});
    CHECK(told == 2);
}

TEST_CASE("What the job of a stack says counts as far as it can be understood") {
    const io::TemporaryFolder folder;
    const std::string own = (folder.path() / "own").string();
    write_marker(own, {});
    const auto with_job = [&](const std::string& text) {
        io::write_whole_file(own + "/job.json", text);
        Progress progress;
        return read_stack_volume({.stack = own}, progress);
    };
    const std::string begin = "{\"format\": \"voxtone-job\", \"version\": 1, ";
    const StackVolume picture = with_job(begin + "\"model\": \"../a.png\", \"backing\": \"white\"}");
    CHECK(picture.of_picture);
    CHECK(picture.backing == optics::Backing::white);
    CHECK_FALSE(with_job(begin + "\"model\": \"../a.obj\", \"backing\": \"white\"}").of_picture);
    for (const char* none : {"{", "[]", "{\"format\": \"other\", \"model\": \"a.png\"}", "{\"model\": 7}"})
        CHECK_FALSE(with_job(none).of_picture);
    // Its resins are seen from where it lies.
    io::write_whole_file(
        folder.path() / "few.json",
        std::string_view(
            R"({"format": "voxtone-resins", "version": 1, "name": "few", "source": "test", "channels": {"kind": "rgb"},
        "g": 0.4, "eta": 1.5, "resins": [{"name": "White", "role": "W", "sigma_t_per_mm": [6, 9, 24], "albedo": [0.999, 0.999, 0.999]}]})"));
    io::write_whole_file(own + "/job.json", begin + "\"resins\": \"../few.json\"}");
    CHECK_THAT(message({.stack = own}, ExitCode::invalid_input), Contains("'few'") && Contains("no optical data"));
}

TEST_CASE("A stack without its job takes the resins of its printer, and says so") {
    const io::TemporaryFolder folder;
    const std::string own = (folder.path() / "own").string();
    write_marker(own, {});
    const auto warnings_of = [&](const std::string& resins) {
        ListeningProgress progress;
        const StackVolume stack = read_stack_volume({.stack = own, .resins = resins}, progress);
        CHECK(stack.resins.name == (resins.empty() ? find_printer("stratasys-j750-hm").default_resins : resins));
        return progress.warnings;
    };
    CHECK_THAT(warnings_of("").at(0), Contains("no job.json says of which resin set it was made") &&
                                          Contains("stratasys-j750-hm") && Contains("--resins") &&
                                          Contains("[changed-input]"));
    CHECK(warnings_of("vero-opaque").empty());
    io::write_whole_file(own + "/job.json", std::string_view("{"));
    CHECK_THAT(warnings_of("").at(0), Contains("cannot be read") && Contains("job.json"));
    io::write_whole_file(own + "/job.json",
                         std::string_view(R"({"format": "voxtone-job", "version": 1, "resins": "vero-opaque"})"));
    ListeningProgress progress;
    CHECK(read_stack_volume({.stack = own}, progress).resins.name == "vero-opaque");
    CHECK(progress.warnings.empty());
}

TEST_CASE("A manifest that was changed after it was written is told") {
    const io::TemporaryFolder folder;
    const std::string own = (folder.path() / "own").string();
    write_marker(own, {});
    const std::filesystem::path file = own + "/manifest.json";
    const auto bytes = io::read_whole_file(file, 1 << 20);
    std::string text(bytes.begin(), bytes.end());
    const std::size_t at = text.find("VeroCyan");
    REQUIRE(at != std::string::npos);
    text.replace(at, 8, "Cyan----");
    io::write_whole_file(file, text);
    ListeningProgress progress;
    (void)read_stack_volume({.stack = own, .resins = "vero-opaque"}, progress);
    REQUIRE(progress.warnings.size() == 1);
    CHECK_THAT(progress.warnings[0], Contains("was changed after it was written") && Contains("[changed-input]"));
}

TEST_CASE("What a stack lacks is said with what to do") {
    const io::TemporaryFolder folder;
    write_marker(folder.path() / "own", {});
    const std::string own = (folder.path() / "own").string(), layers = own + "/layers";
    // A set without yellow.
    io::write_whole_file(
        folder.path() / "few.json",
        std::string_view(
            R"({"format": "voxtone-resins", "version": 1, "name": "few", "source": "test", "channels": {"kind": "rgb"},
        "g": 0.4, "eta": 1.5, "resins": [{"name": "White", "role": "W", "sigma_t_per_mm": [6, 9, 24], "albedo": [0.999, 0.999, 0.999]}]})"));
    CHECK_THAT(message({.stack = own, .resins = (folder.path() / "few.json").string()}, ExitCode::invalid_input),
               Contains("VeroCyan") && Contains("no optical data") && Contains("few") && Contains("--resins"));
    CHECK_THAT(message({.stack = own, .pitch_mm = parse_pitch_mm("1,1,1mm")}, ExitCode::usage), Contains("manifest"));
    CHECK_THAT(message({.stack = layers}, ExitCode::invalid_input), Contains("--pitch") && Contains("--printer"));
    CHECK_THAT(message({.stack = layers, .printer = "stratasys-j750-hm"}, ExitCode::invalid_input),
               Contains("--assign") && Contains("#00aeef=?") && Contains("C, M, Y, K, W"));
    // A name of other cartridges than the printer's set is of.
    CHECK_THAT(message({.stack = layers, .printer = "stratasys-j750-hm", .assign = assigned(sample_colours)},
                       ExitCode::invalid_input),
               Contains("'VeroYellow'") && Contains("'j750-vivid'") && Contains("--resins"));
    auto some = vivid_colours;
    some.pop_back();
    CHECK_THAT(
        message({.stack = layers, .printer = "stratasys-j750-hm", .assign = assigned(some)}, ExitCode::invalid_input),
        Contains("#dcded8") && Contains("stands for no resin") && Contains("slice_000"));
    some.push_back("#dcded8=X");
    CHECK_THAT(
        message({.stack = layers, .printer = "stratasys-j750-hm", .assign = assigned(some)}, ExitCode::invalid_input),
        Contains("'X'") && Contains("--resins"));
    CHECK_THAT(message({.stack = own, .memory_bytes = 1000}, ExitCode::unfinished),
               Contains("more than the 1 KiB") && Contains("--memory"));
    std::filesystem::remove(layers + "/slice_00007.png");
    CHECK_THAT(message({.stack = own}, ExitCode::invalid_input), Contains("missing") && Contains("slice_00007"));
}

TEST_CASE("A pitch is three lengths") {
    CHECK(parse_pitch_mm("42.5,84.5,27um")[1] == Approx(0.0845));
    CHECK(parse_pitch_mm("0.04,80um,0.03")[1] == Approx(0.08));
    CHECK_THROWS_AS(parse_pitch_mm("42,84"), UsageError);
    CHECK_THROWS_AS(parse_pitch_mm("42,84,27"), UsageError);  // 42 mm
    CHECK_THROWS_AS(parse_pitch_mm("a,b,c"), UsageError);
}

TEST_CASE("A colour is assigned by its code") {
    CHECK(parse_assignment("#00aeef=C").rgb == std::array<std::uint8_t, 3>{0x00, 0xae, 0xef});
    CHECK(parse_assignment("#00aeef=C").role == "C");
    for (const char* bad : {"dcded8=W", "#dcded8", "#dcded8=", "#dcde=W", "=W", ""})
        CHECK_THROWS_WITH(parse_assignment(bad), Contains("#rrggbb=ROLE"));
}

namespace {

/// Layers of 20 x 12 px as another program writes them: a block of white with a red one in it, in a margin of nothing.
struct DrawnStack {
    using Pixel = std::array<std::uint8_t, 4>;
    Pixel nothing{0, 0, 0, 0}, white{255, 255, 255, 255}, red{200, 40, 40, 255};
    std::optional<Pixel> edge{};  ///< of the white block, at its left
    int layers = 6;

    void write(const std::filesystem::path& folder, const std::string& form = "slice_{}.png") const {
        for (int k = 1; k <= layers; ++k) write_layer(folder / fmt::format(fmt::runtime(form), k));
    }
    void write_layer(const std::filesystem::path& file, std::uint32_t width = 20) const {
        constexpr std::uint32_t height = 12;
        std::vector<std::uint8_t> pixels;
        for (std::uint32_t y = 0; y < height; ++y)
            for (std::uint32_t x = 0; x < width; ++x) {
                const bool in_white = x >= 5 && x < 15 && y >= 2 && y < 10;
                const Pixel& p = in_white                             ? (x >= 8 && x < 11 ? red : white)
                                 : edge && x == 4 && y >= 2 && y < 10 ? *edge
                                                                      : nothing;
                pixels.insert(pixels.end(), p.begin(), p.end());
            }
        io::write_whole_file(file, io::png_bytes({width, height, 4, pixels}));
    }
};

StackVolume read_drawn(const std::filesystem::path& folder, const std::vector<std::string>& colours, bool nearest,
                       Progress& progress) {
    return read_stack_volume({.stack = folder.string(),
                              .pitch_mm = parse_pitch_mm("0.05,0.08,0.03mm"),
                              .assign = assigned(colours),
                              .nearest = nearest},
                             progress);
}

const std::vector<std::string> drawn_colours{"#ffffff=W", "#c82828=M"};

}  // namespace

TEST_CASE("Pixels of alpha 0 are nothing, whatever their colour") {
    const DrawnStack::Pixel clear_black{0, 0, 0, 0}, clear_white{255, 255, 255, 0}, clear_red{200, 40, 40, 0},
        clear_stray{12, 34, 56, 0};
    for (const DrawnStack::Pixel& nothing : {clear_black, clear_white, clear_red, clear_stray}) {
        const io::TemporaryFolder folder;
        DrawnStack{.nothing = nothing}.write(folder.path());
        ListeningProgress progress;
        const StackVolume stack = read_drawn(folder.path(), drawn_colours, false, progress);
        CHECK(stack.volume.size() == std::array<int, 3>{10, 8, 6});
        CHECK(progress.warnings.empty());
    }
    // Black may be a resin beside them.
    const io::TemporaryFolder folder;
    DrawnStack{.red = {0, 0, 0, 255}}.write(folder.path());
    Progress progress;
    const StackVolume stack = read_drawn(folder.path(), {"#ffffff=W", "#000000=K"}, false, progress);
    CHECK(stack.volume.count()[optics::air] == 0);
}

TEST_CASE("Black amid transparent pixels is asked about: it is no background there") {
    const io::TemporaryFolder folder;
    DrawnStack{.red = {0, 0, 0, 255}}.write(folder.path());
    Progress progress;
    CHECK_THROWS_WITH(
        read_drawn(folder.path(), {"#ffffff=W"}, false, progress),
        Contains("pixels of #000000 amid a transparent background") && Contains("\"#000000=W\"") && Contains("none"));
    const StackVolume told = read_drawn(folder.path(), {"#ffffff=W", "#000000=none"}, false, progress);
    CHECK(told.volume.count()[optics::air] > 0);
    // Around an opaque picture black is what nobody has to tell.
    const io::TemporaryFolder opaque;
    DrawnStack{.nothing = {0, 0, 0, 255}}.write(opaque.path());
    CHECK(read_drawn(opaque.path(), drawn_colours, false, progress).volume.count()[optics::air] == 0);
}

TEST_CASE("Smoothed edges are refused with a way out, which is one", "[slow]") {
    struct Edge {
        DrawnStack::Pixel colour;
        int columns;  ///< of the body: whether the edge is nearer to white than to nothing
        const char* words;
    };
    const Edge grey{{127, 127, 127, 255}, 10, "48 pixels of #7f7f7f, which stands for no resin"},
        light{{200, 200, 200, 255}, 11, "of #c8c8c8, which stands for no resin"},
        soft{{255, 255, 255, 128}, 11, "#ffffff of alpha 128, the first in slice_1.png, column 4, row 2"},
        faint{{255, 255, 255, 127}, 10, "of alpha 127"};
    for (const Edge& edge : {grey, light, soft, faint}) {
        INFO(edge.words);
        const io::TemporaryFolder folder;
        DrawnStack{.edge = edge.colour}.write(folder.path());
        const StackVolumeOptions told{.stack = folder.path().string(),
                                      .pitch_mm = parse_pitch_mm("0.05,0.08,0.03mm"),
                                      .assign = assigned(drawn_colours)};
        CHECK_THAT(message(told, ExitCode::invalid_input), Contains(edge.words) && Contains("--nearest"));
        ListeningProgress progress;
        const StackVolume stack = read_drawn(folder.path(), drawn_colours, true, progress);
        CHECK(stack.volume.size()[0] == edge.columns);
        const auto count = stack.volume.count();
        CHECK(count[static_cast<std::size_t>(1 + stack.resins.find("M"))] == 3 * 8 * 6);  // no edge of white is red
        REQUIRE(progress.warnings.size() == 1);
        CHECK_THAT(progress.warnings[0],
                   Contains("48 pixels") && Contains("--nearest") && Contains("[nearest-colour]"));
        // Nothing told yet: what is said then is enough.
        StackVolumeOptions untold = told;
        untold.assign.clear();
        untold.nearest = true;
        CHECK_THAT(message(untold, ExitCode::invalid_input),
                   Contains("--assign \"#ffffff=?,#c82828=?") && Contains("add --nearest"));
    }
    // What was told to stand for nothing, and does not occur, is nobody's nearest: black is here.
    const io::TemporaryFolder folder;
    DrawnStack{.nothing = {0, 255, 0, 255}, .edge = DrawnStack::Pixel{20, 20, 20, 255}}.write(folder.path());
    ListeningProgress progress;
    const StackVolume stack = read_drawn(folder.path(), {"#ffffff=W", "#c82828=M", "#00ff00=none"}, true, progress);
    CHECK(stack.volume.size()[0] == 11);  // red is nearer than green
}

TEST_CASE("A colour that occurs half transparent alone is somebody's nearest") {
    const io::TemporaryFolder folder;
    DrawnStack{.white = {255, 255, 255, 200}, .red = {200, 40, 40, 200}}.write(folder.path());
    ListeningProgress progress;
    CHECK(read_drawn(folder.path(), drawn_colours, true, progress).volume.size() == std::array<int, 3>{10, 8, 6});
}

TEST_CASE("Of many colours those of many pixels are to be assigned") {
    const io::TemporaryFolder folder;
    for (int k = 1; k <= 20; ++k) {
        const auto grey = static_cast<std::uint8_t>(5 * k);
        DrawnStack{.edge = DrawnStack::Pixel{grey, grey, grey, 255}}.write_layer(
            folder.path() / ("slice_" + std::to_string(k) + ".png"));
    }
    CHECK_THAT(message({.stack = folder.path().string(), .pitch_mm = parse_pitch_mm("0.05,0.08,0.03mm")},
                       ExitCode::invalid_input),
               Contains("its 22 colours are") && Contains("--assign \"#ffffff=?,#c82828=?\"; leave"));
}

TEST_CASE("A colour of many pixels that --nearest takes away is asked about") {
    const io::TemporaryFolder folder;
    DrawnStack{}.write(folder.path());
    ListeningProgress progress;
    (void)read_drawn(folder.path(), {"#ffffff=W"}, true, progress);
    REQUIRE(progress.warnings.size() == 1);
    CHECK_THAT(progress.warnings[0], Contains("#c82828") && Contains("hardly an edge"));
}

TEST_CASE("All colours that stand for nothing are told at once, and the layer that is of another size") {
    const io::TemporaryFolder folder;
    DrawnStack{.edge = DrawnStack::Pixel{1, 2, 3, 255}}.write(folder.path());
    const StackVolumeOptions told{.stack = folder.path().string(),
                                  .pitch_mm = parse_pitch_mm("0.05,0.08,0.03mm"),
                                  .assign = assigned({"#ffffff=W"})};
    CHECK_THAT(message(told, ExitCode::invalid_input), Contains("--assign \"#c82828=W,#010203=W\""));
    // What lies in the corner is the background.
    const io::TemporaryFolder filled;
    DrawnStack{.nothing = {0, 255, 0, 255}}.write(filled.path());
    StackVolumeOptions of_filled = told;
    of_filled.stack = filled.path().string();
    CHECK_THAT(message(of_filled, ExitCode::invalid_input), Contains("#00ff00=none") && Contains("#c82828=W"));
    io::write_whole_file(folder.path() / "slice_2.png", std::string_view("\xff\xd8\xff\xe0 a JPEG file"));
    CHECK_THAT(message(told, ExitCode::invalid_input), Contains("slice_2.png: is no PNG file by its first bytes"));
    DrawnStack{}.write_layer(folder.path() / "slice_2.png");
    DrawnStack{}.write_layer(folder.path() / "slice_3.png", 21);
    CHECK_THAT(message(told, ExitCode::invalid_input), Contains("slice_3.png is 21 x 12 px, but 5 of the 6 layers"));
}

TEST_CASE("Layers that are missing and files that look like some are told") {
    const io::TemporaryFolder folder;
    DrawnStack{.layers = 8}.write(folder.path());
    std::filesystem::remove(folder.path() / "slice_4.png");
    DrawnStack{.layers = 3}.write(folder.path(), "other_{}.png");
    ListeningProgress progress;
    const StackVolume stack = read_drawn(folder.path(), drawn_colours, false, progress);
    CHECK(stack.volume.size()[2] == 7);
    REQUIRE(progress.warnings.size() == 2);
    CHECK_THAT(progress.warnings[0], Contains("number 4 is missing"));
    CHECK_THAT(progress.warnings[1], Contains("3 files are left out") && Contains("other_1.png to other_3.png"));
}

TEST_CASE("Bitmaps beside the layers of an own stack are told") {
    const io::TemporaryFolder folder;
    const auto own = folder.path() / "own";
    write_marker(own, {});
    std::filesystem::copy(own / "layers/slice_00003.png", own / "layers/slice_00035.png");
    ListeningProgress progress;
    CHECK(read_stack_volume({.stack = own.string(), .resins = "vero-opaque"}, progress).volume.size()[2] == nz);
    REQUIRE(progress.warnings.size() == 1);
    CHECK_THAT(progress.warnings[0], Contains("1 bitmap beside its layers is left out") && Contains("slice_00035"));
}

TEST_CASE("Heights, and numbers below 0, are layers in their order") {
    for (const char* form : {"slice-0.{:03}mm.png", "x_{}_12.png"}) {
        const io::TemporaryFolder folder;
        DrawnStack{.layers = 12}.write(folder.path(), form);
        ListeningProgress progress;
        CHECK(read_drawn(folder.path(), drawn_colours, false, progress).volume.size()[2] == 12);
        CHECK(progress.warnings.empty());
    }
    const io::TemporaryFolder folder;
    DrawnStack{.layers = 5}.write(folder.path(), "slice_-{}.png");
    DrawnStack{.layers = 5}.write(folder.path(), "slice_{}.png");
    ListeningProgress progress;
    CHECK(read_drawn(folder.path(), drawn_colours, false, progress).volume.size()[2] == 10);
    REQUIRE(progress.warnings.size() == 2);
    CHECK_THAT(progress.warnings[0], Contains("number 0 is missing"));
    CHECK_THAT(progress.warnings[1], Contains("5 of 10 layers have numbers below 0"));
}

TEST_CASE("A folder without layers is told by what it holds") {
    const io::TemporaryFolder folder;
    const auto inner = folder.path() / "png";
    std::filesystem::create_directory(inner);
    DrawnStack{}.write(inner);
    CHECK_THAT(message({.stack = folder.path().string()}, ExitCode::invalid_input), Contains("name " + inner.string()));
    io::write_whole_file(folder.path() / "slice_1.tif", std::string_view("II*"));
    CHECK_THAT(message({.stack = folder.path().string()}, ExitCode::invalid_input),
               Contains("1 file like slice_1.tif") && Contains("save them as PNG"));
}
