// SPDX-License-Identifier: GPL-3.0-or-later
//
// OUT/printer: what is in it, that it is verified wherever it lies, and how it is handed over.
#include "io/printer/printer_folder.h"

#include <sys/stat.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <fstream>
#include <set>

#include "base/error.h"
#include "io/files/whole_file.h"
#include "io/files/zip_reader.h"
#include "io/layers/stack_folder.h"
#include "io/layers/stack_reader.h"
#include "tests/io/files/temporary_folder.h"
#include "tests/io/layers/stack_samples.h"

using namespace voxtone;
using namespace voxtone::io;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

constexpr std::uint32_t layers = 31;

std::string page_of(const StackDescription& stack, const std::string& title) {
    return "<html><h1>" + title + " </h1>" + manifest_for_page(manifest_text(stack)) + "</html>";
}

/// `seed`: which print it is.
StackDescription write_print(const fs::path& out, StackOutputs outputs = {}, std::uint32_t seed = 0,
                             const std::string& title = "a </script> print") {
    outputs.printer_folder = true;
    LayerStackWriter writer(out, sample_description(layers), outputs, true);
    for (std::uint32_t k = 0; k < layers; ++k) writer.write(k, sample_layer(k + 100 * seed));
    return writer.finish({}, nullptr,
                         [&](const StackDescription& stack, const TopmostLayers&) { return page_of(stack, title); });
}

std::set<std::string> listing(const fs::path& folder) {
    std::set<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(folder))
        if (!entry.is_directory()) names.insert(entry.path().lexically_relative(folder).string());
    return names;
}

std::set<std::string> layer_listing(const std::string& before = "layers/") {
    std::set<std::string> names;
    for (std::uint32_t k = 0; k < layers; ++k)
        names.insert(before + fs::path(sample_description(layers).layer_path(k)).filename().string());
    return names;
}

std::set<std::string> with(std::set<std::string> names, const std::set<std::string>& more) {
    names.insert(more.begin(), more.end());
    return names;
}

ino_t inode_of(const fs::path& file) {
    struct stat status {};
    REQUIRE(stat(file.c_str(), &status) == 0);
    return status.st_ino;
}

void append(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::app) << text; }

void replace_in(const fs::path& file, const std::string& from, const std::string& to) {
    std::string text = text_of(file);
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    write_whole_file(file, text.replace(at, from.size(), to));
}

}  // namespace

TEST_CASE("The printer's folder holds what its computer takes and nothing else", "[printer-folder]") {
    TemporaryFolder folder;
    const fs::path out = folder.path() / "out", printer = out / "printer";
    const std::set<std::string> page{"HOW-TO-PRINT.html"};
    (void)write_print(out);
    CHECK(listing(printer) == with(layer_listing(), page));
    (void)write_print(out, {.gcvf = true});
    CHECK(listing(printer) == with(page, {"stack.gcvf"}));
    (void)write_print(out, {.gcvf = true, .vdb = true, .png = true});
    CHECK(listing(printer) == with(with(layer_listing(), page), {"stack.gcvf"}));
    (void)write_print(out, {.vdb = true});
    CHECK(listing(printer) == with(layer_listing(), page));
    (void)write_print(out, {.resin_bitmaps = ResinBitmaps::png8});
    CHECK(listing(printer) == with(layer_listing("resins/indexed/"), page));
}

TEST_CASE("Layers in it take no room twice where the file system has links", "[printer-folder]") {
    TemporaryFolder folder;
    const fs::path out = folder.path() / "out";
    const StackDescription stack = write_print(out, {.gcvf = true, .png = true});
    REQUIRE(has_hard_links(folder.path()));
    for (const std::string& name : {stack.layer_path(7), std::string("stack.gcvf")})
        CHECK(inode_of(out / name) == inode_of(out / "printer" / name));
}

TEST_CASE("It is verified by itself, with all that the stack announces", "[printer-folder]") {
    TemporaryFolder folder;
    const fs::path out = folder.path() / "out", taken = folder.path() / "taken";
    const StackDescription stack = write_print(out);
    fs::copy(out / "printer", taken, fs::copy_options::recursive);
    const StackReport good = verify_stack(taken);
    INFO(report_text(good));
    CHECK(good.passed());
    CHECK(good.kind == StackReader::Kind::voxtone);
    CHECK(good.content_sha256 == stack.content_sha256);
    CHECK(StackReader(taken).description() == stack);

    append(taken / "notes.txt", "x");
    CHECK(has(verify_stack(taken), "stranger", "notes.txt"));
    fs::remove(taken / "notes.txt");
    fs::copy_file(taken / stack.layer_path(3), taken / stack.layer_path(4), fs::copy_options::overwrite_existing);
    CHECK(has(verify_stack(taken), "digest"));
    fs::copy_file(out / stack.layer_path(4), taken / stack.layer_path(4), fs::copy_options::overwrite_existing);
    fs::remove(taken / stack.layer_path(30));
    CHECK(has(verify_stack(taken), "missing-layer", "slice_00030.png"));
    fs::copy_file(out / stack.layer_path(30), taken / stack.layer_path(30));
    CHECK(verify_stack(taken).passed());
    // Who swaps names of resins on the page loads the wrong ones.
    replace_in(taken / "HOW-TO-PRINT.html", "VeroCyan", "VeroCyam");
    CHECK(has(verify_stack(taken), "manifest", "was changed"));
    replace_in(taken / "HOW-TO-PRINT.html", "id=\"manifest\"", "id=\"other\"");
    CHECK(has(verify_stack(taken), "manifest", "does not say what the colours"));

    (void)write_print(out, {.gcvf = true});
    CHECK(verify_stack(out / "printer").passed());
    CHECK(verify_stack(out / "printer").kind == StackReader::Kind::gcvf);
    (void)write_print(out, {.resin_bitmaps = ResinBitmaps::png1});
    CHECK(has(verify_stack(out / "printer"), "no-layers", "bitmaps of single resins"));
}

TEST_CASE("It is handed over as a folder or as one file, once", "[printer-folder]") {
    TemporaryFolder folder;
    const fs::path out = folder.path() / "out", to = folder.path() / "usb/job", file = folder.path() / "usb/job.zip";
    (void)write_print(out);
    CHECK(hand_to_printer(out, to, false, nullptr));
    CHECK(listing(to) == listing(out / "printer"));
    CHECK(verify_stack(to).passed());
    CHECK_FALSE(hand_to_printer(out, to, false, nullptr));
    CHECK(hand_to_printer(out, file, false, nullptr));
    CHECK_FALSE(hand_to_printer(out, file, false, nullptr));
    const ZipReader zip(file);
    CHECK(std::set<std::string>(zip.names().begin(), zip.names().end()) == listing(out / "printer"));
    for (std::size_t n = 0; n < zip.names().size(); ++n)
        CHECK(zip.read(n, 1 << 26) == read_whole_file(out / "printer" / zip.names()[n], 1 << 26));
    CHECK(verify_stack(file).passed());
    CHECK(listing(folder.path() / "usb").size() == listing(to).size() + 1);  // nothing half-made beside them

    // Another print does not take their place unasked.
    (void)write_print(out, {}, 1);
    for (const fs::path& target : {to, file}) {
        CHECK_THROWS_WITH(expect_printer_target(out, target, false), Contains("holds another print"));
        CHECK_THROWS_AS(hand_to_printer(out, target, false, nullptr), InputError);
        CHECK_NOTHROW(expect_printer_target(out, target, true));
        CHECK(hand_to_printer(out, target, true, nullptr));
        CHECK_FALSE(hand_to_printer(out, target, true, nullptr));
    }
    CHECK(text_of(to / "HOW-TO-PRINT.html") == text_of(out / "printer/HOW-TO-PRINT.html"));
    CHECK(verify_stack(to).passed());
    CHECK(listing(folder.path() / "usb").size() == listing(to).size() + 1);
}

TEST_CASE("What was not made for a printer is never replaced, and OUT is no place for it", "[printer-folder]") {
    TemporaryFolder folder;
    const fs::path out = folder.path() / "out";
    (void)write_print(out);
    fs::create_directories(folder.path() / "holiday");
    append(folder.path() / "holiday/a.jpg", "x");
    append(folder.path() / "mine.zip", "PK");
    append(folder.path() / "mine.txt", "x");
    fs::create_directories(folder.path() / "empty");
    CHECK(hand_to_printer(out, folder.path() / "added", false, nullptr));
    append(folder.path() / "added/letter.txt", "x");
    (void)write_print(out, {}, 1);
    for (const char* name : {"holiday", "mine.zip", "mine.txt", "added"}) {
        CAPTURE(name);
        CHECK_THROWS_WITH(expect_printer_target(out, folder.path() / name, true), Contains("name another place"));
        CHECK_THROWS_AS(hand_to_printer(out, folder.path() / name, true, nullptr), InputError);
    }
    CHECK(text_of(folder.path() / "holiday/a.jpg") == "x");
    CHECK(text_of(folder.path() / "added/letter.txt") == "x");
    CHECK_THROWS_WITH(expect_printer_target(out, out / "sub/for", true), Contains("lies in the output folder"));
    CHECK_THROWS_WITH(expect_printer_target(out, out, true), Contains("lies in the output folder"));
    CHECK(hand_to_printer(out, folder.path() / "empty", false, nullptr));
    CHECK_THROWS_AS(hand_to_printer(out, folder.path() / "mine.txt/job", false, nullptr), Error);
    CHECK_THROWS_AS(hand_to_printer(out, folder.path() / "mine.txt/job.zip", false, nullptr), Error);
    // A stack without it says so.
    fs::remove_all(out / "printer");
    CHECK_THROWS_WITH(hand_to_printer(out, folder.path() / "new", false, nullptr), Contains("make it again"));
}

TEST_CASE("On another file system it is copied", "[printer-folder]") {
    TemporaryFolder folder;
    const fs::path shm = "/dev/shm";
    struct stat here {
    }, there{};
    if (stat(folder.path().c_str(), &here) != 0 || stat(shm.c_str(), &there) != 0 || here.st_dev == there.st_dev) {
        WARN("skipped: /dev/shm is no other file system here");
        return;
    }
    const fs::path out = folder.path() / "out", to = shm / ("voxtone-printer-" + std::to_string(getpid()));
    const StackDescription stack = write_print(out);
    CHECK(hand_to_printer(out, to, false, nullptr));
    CHECK(verify_stack(to).passed());
    CHECK(inode_of(to / stack.layer_path(0)) != inode_of(out / stack.layer_path(0)));
    fs::remove_all(to);
}

TEST_CASE("A new stack takes the place of the old printer's folder, and what is not of it is set aside",
          "[printer-folder]") {
    TemporaryFolder folder;
    const fs::path out = folder.path() / "out";
    fs::create_directories(out / "printer/layers");
    append(out / "printer/driver.exe", "x");
    append(out / "printer/layers/photo.png", "x");
    {
        StackFolder taken(out);
        CHECK_THAT(taken.strangers_note(), Contains("printer") && Contains("1 more"));
        CHECK_THROWS_AS(taken.expect_free(), InputError);
    }
    (void)write_print(out);
    CHECK(listing(out / "printer") == with(layer_listing(), {"HOW-TO-PRINT.html"}));
    CHECK(listing(out / "set-aside") == std::set<std::string>{"printer/driver.exe", "printer/layers/photo.png"});
    (void)write_print(out, {.gcvf = true}, 1);
    CHECK(listing(out / "printer") == std::set<std::string>{"HOW-TO-PRINT.html", "stack.gcvf"});
    CHECK(listing(out / "set-aside").size() == 2);
    // A link in its place would lead elsewhere.
    fs::remove_all(out / "printer");
    fs::create_directory_symlink(folder.path(), out / "printer");
    CHECK_THROWS_AS(StackFolder(out), FileError);
}

TEST_CASE("The container alone is handed over under a name of its own, once", "[printer-folder]") {
    TemporaryFolder folder;
    const fs::path out = folder.path() / "out", usb = folder.path() / "usb", to = usb / "job.gcvf";
    (void)write_print(out);
    CHECK_THROWS_WITH(hand_to_printer(out, to, false, nullptr), Contains("has no GCVF file"));
    CHECK(listing(usb).empty());
    (void)write_print(out, {.gcvf = true});
    CHECK(hand_to_printer(out, to, false, nullptr));
    CHECK(listing(usb) == std::set<std::string>{"job.gcvf"});
    CHECK(text_of(to) == text_of(out / "printer/stack.gcvf"));
    CHECK(verify_stack(to).passed());
    CHECK_FALSE(hand_to_printer(out, to, false, nullptr));
    // A copy is as good as a second name; one byte less or another is not.
    std::string bytes = text_of(to);
    fs::remove(to);
    write_whole_file(to, bytes);
    CHECK_FALSE(hand_to_printer(out, to, false, nullptr));
    for (const bool shorter : {true, false}) {
        std::string other = bytes;
        if (shorter)
            other.pop_back();
        else
            other[other.size() / 2] = char(other[other.size() / 2] ^ 1);
        fs::remove(to);
        write_whole_file(to, other);
        CHECK_THROWS_AS(hand_to_printer(out, to, false, nullptr), InputError);
        CHECK(text_of(to) == other);
    }
    fs::remove(to);
    CHECK(hand_to_printer(out, to, false, nullptr));
    (void)write_print(out, {.gcvf = true}, 1);
    CHECK_THROWS_WITH(hand_to_printer(out, to, false, nullptr), Contains("holds another print"));
    CHECK(hand_to_printer(out, to, true, nullptr));
    CHECK(text_of(to) == text_of(out / "printer/stack.gcvf"));
    CHECK(listing(usb) == std::set<std::string>{"job.gcvf"});
    // What only has the name is nobody's to replace.
    (void)hand_to_printer(out, usb / "job.zip", false, nullptr);
    fs::rename(usb / "job.zip", usb / "zip.gcvf");
    append(usb / "text.gcvf", "x");
    fs::create_directory(usb / "folder.gcvf");
    append(usb / "folder.gcvf/a", "x");
    for (const char* name : {"zip.gcvf", "text.gcvf", "folder.gcvf"})
        CHECK_THROWS_WITH(expect_printer_target(out, usb / name, true), Contains("name another place"));
}

TEST_CASE("Handing over that is stopped leaves what was there, and nothing half-made", "[printer-folder]") {
    TemporaryFolder folder;
    const fs::path out = folder.path() / "out", usb = folder.path() / "usb";
    (void)write_print(out);
    for (const char* name : {"job", "job.zip"}) (void)hand_to_printer(out, usb / name, false, nullptr);
    const std::set<std::string> before = listing(usb);
    const std::string page = text_of(usb / "job/HOW-TO-PRINT.html"), zip = text_of(usb / "job.zip");
    (void)write_print(out, {}, 1);
    Progress stopped;
    stopped.cancel();
    for (const char* name : {"job", "job.zip", "new", "new.zip"})
        CHECK_THROWS_AS(hand_to_printer(out, usb / name, true, &stopped), Error);
    CHECK(listing(usb) == before);
    CHECK(text_of(usb / "job/HOW-TO-PRINT.html") == page);
    CHECK(text_of(usb / "job.zip") == zip);
}

TEST_CASE("A page gives back the manifest that it was made with, and a torn one gives none", "[printer-folder]") {
    StackDescription stack = sample_description(3);
    stack.size_mm = stack_size_mm(stack);
    stack.content_sha256 = std::string(64, 'a');
    const std::string page = "<p>" + manifest_for_page(manifest_text(stack));
    REQUIRE(manifest_in_page(page));
    CHECK(parse_manifest(*manifest_in_page(page), "page") == stack);
    // The last one is the page's own: a title may spell another.
    CHECK(manifest_in_page(manifest_for_page("{}") + page) == manifest_in_page(page));
    CHECK_FALSE(manifest_in_page("<p>nothing"));
    CHECK_FALSE(manifest_in_page(page.substr(0, page.rfind("</script>"))));
}
