// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/models/foreign_kind.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <string_view>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "io/files/xml_reader.h"
#include "io/models/model_reader.h"
#include "io/models/model_text.h"

namespace voxtone::io {

namespace {

using namespace std::string_view_literals;

constexpr std::string_view from_cad =
                               "it holds exact surfaces and no mesh; open it in a CAD program and export it as "
                               "GLB, 3MF or OBJ (FreeCAD opens STEP and IGES)",
                           from_blender = "open it in Blender and export it as GLB",
                           from_meshlab =
                               "open it in MeshLab and export it as PLY (colours of vertices) or OBJ "
                               "(textures)",
                           from_its_program = "open it in the program that made it and export it as GLB, 3MF or OBJ",
                           from_draco =
                               "unpack it (draco_decoder -i IN -o OUT.ply does), or export it as GLB, which may be "
                               "compressed with Draco",
                           from_slicer = "open it in a slicer (PrusaSlicer reads it) and export it as 3MF",
                           from_scan =
                               "it holds voxels of a scan and no surface; segment it (3D Slicer does) and "
                               "export the segments as OBJ",
                           from_volume =
                               "it holds a volume and no surface; make one (ParaView: Contour) and export it "
                               "as PLY",
                           from_points =
                               "it holds points and no faces; make a mesh of them (MeshLab or CloudCompare "
                               "do) and export it as PLY",
                           from_splats =
                               "it holds blobs of colour and no surface; export a mesh (GLB, OBJ or PLY) from the "
                               "program that scanned them",
                           unpack = "unpack it and give the model that is in it, its textures beside it",
                           as_png = "save it as PNG or TIFF",
                           drawn = "it is drawn by lines and has no pixels; export it as PNG, of 300 dpi or more",
                           sliced = "it was made for a printer already; give the model that it was made of",
                           again = "download the file itself again",
                           export_in_it = "export the model or the picture in it as a file of its own";

/// What the bytes of a kind may be that has no mark of its own.
enum class Inside : std::uint8_t {
    anything,  ///< an archive, too
    picture,   ///< the bytes of one that can be read, which is not what is meant
    text
};

/// A kind of file that is not read: what it is called, how names of it end, what to do.
struct Kind {
    std::string_view what, endings, remedy;
    Inside inside = Inside::anything;
};

namespace kinds {
constexpr Kind step{"a STEP file", "step stp p21 stpz", from_cad}, iges{"an IGES file", "iges igs", from_cad},
    ifc{"an IFC file of a building", "ifc ifczip", "open it in Blender (Bonsai) or FreeCAD and export it as GLB"},
    ole{"a SolidWorks or Inventor file", "sldprt sldasm slddrw ipt iam idw", from_its_program},
    rhino{"a Rhino file", "3dm", from_its_program}, dwg{"an AutoCAD drawing", "dwg", from_its_program},
    x3d{"an X3D scene", "x3d x3dv x3db x3dz", from_meshlab}, blend{"a Blender file", "blend blend1", from_blender},
    dae{"a Collada scene", "dae zae", from_blender}, usd{"a USD scene", "usd usda usdc usdz", from_blender},
    max3ds{"a 3D Studio model", "3ds", from_meshlab}, alembic{"an Alembic scene", "abc", from_blender},
    off{"an OFF model", "off coff noff", from_meshlab}, draco{"a bare Draco stream", "drc", from_draco},
    amf{"an AMF model", "amf", from_slicer}, dcm{"a DICOM file of a scanner", "dcm dicom ima", from_scan},
    nifti{"a NIfTI scan", "nii nii.gz", from_scan}, nrrd{"an NRRD volume", "nrrd nhdr", from_scan},
    meta{"a MetaImage volume", "mha mhd", from_scan},
    vtk{"a VTK file", "vtk vtu vtp vti vts vtr vtm pvd", "open it in ParaView and export its surface as PLY or GLB"},
    vdb{"an OpenVDB volume", "vdb nvdb", from_volume}, las{"a point cloud (LAS)", "las laz", from_points},
    e57{"a point cloud (E57)", "e57", from_points}, pcd{"a point cloud (PCD)", "pcd", from_points},
    zip{"a ZIP archive", "zip objzf", unpack}, rar{"a RAR archive", "rar", unpack},
    seven{"a 7-Zip archive", "7z 7z.001", unpack}, gzip{"compressed (gzip)", "gz tgz", unpack},
    xz{"compressed (xz)", "xz txz", unpack}, bzip{"compressed (bzip2)", "bz2 tbz", unpack},
    zstd{"compressed (Zstandard)", "zst zstd", unpack}, tar{"a TAR archive", "tar", unpack},
    svg{"an SVG drawing", "svg svgz", drawn}, pdf{"a PDF document", "pdf", drawn},
    eps{"a PostScript drawing", "eps ps", drawn}, heic{"a HEIC picture", "heic heif hif", as_png},
    avif{"an AVIF picture", "avif avifs", as_png}, jxl{"a JPEG XL picture", "jxl", as_png},
    jp2{"a JPEG 2000 picture", "jp2 j2k jpf jpx j2c", as_png}, xcf{"a GIMP file", "xcf", as_png},
    dds{"a DDS texture", "dds", as_png}, ktx{"a KTX texture", "ktx ktx2", as_png},
    film{"a film", "mp4 mov m4v avi mkv webm", "save the picture that you want of it as PNG"},
    html{"a web page (HTML), as servers send it in place of a file", "html htm xhtml mhtml", again},
    sent{"a message of a server in place of a file", "", again},
    lfs{"a pointer of Git LFS and not the file itself", "", "get the file: git lfs pull"},
    xml{"XML of another kind", "", from_its_program},
    zeros{"nothing but zeros, as a broken download leaves", "", again}, job{"a voxtone job", "", "give it with --job"};
}  // namespace kinds

/// Kinds that are known by their names alone.
constexpr Kind by_name[] = {
    {"a CAD file",
     "catpart catproduct prt asm x_t x_b xmt_txt sat sab jt par psm f3d f3z fcstd skp 3dxml model dgn scad",
     from_its_program},
    {"a DXF drawing", "dxf", drawn},
    {"a scene of another program",
     "ma mb max c4d lwo lxo hip hiplc bgeo ztl zpr spp mud skb dts ms3d x b3d mdl md2 md3 bvh pmx vox binvox ctm "
     "lib4d u3d prc cob glsl unitypackage uasset",
     from_its_program},
    {"a scan", "mnc mgh mgz hdr.gz img par rec czi lif oib nd2 mrc map", from_scan},
    {"a point cloud", "xyz pts ptx asc fls rcp ptc", from_points},
    {"a file of Gaussian splats", "splat ksplat spz sog", from_splats},
    {"instructions for a printer",
     "gcode gco bgcode nc tap ctb cbddlp photon sl1 sl1s chitubox form fdg3d objet x3g makerbot ufp clt slc cli svgx",
     sliced, Inside::text},
    {"a stack", "gcvf", "`voxtone predict` and `voxtone verify` take it"},
    {"a raw picture of a camera", "cr2 cr3 crw nef nrw arw sr2 srf dng raf orf rw2 pef raw 3fr iiq", as_png,
     Inside::picture},
    {"a drawing", "ai cdr cdt emf wmf fig vsd vsdx odg indd afdesign sketch", drawn},
    {"a picture of another program", "kra clip procreate afphoto pdn ico icns cur sai ora qoi pcx", as_png},
    {"a document", "doc docx odt rtf ppt pptx odp xls xlsx ods pages key numbers epub txt md", export_in_it},
    {"a library of materials and no model", "mtl", "give the OBJ file that names it", Inside::text},
    {"a table of jobs", "csv jsonl ndjson", "`voxtone batch` takes it", Inside::text},
    {"an archive", "lz lzma z cab iso dmg arj lzh cbz jar apk deb rpm 3mfz", unpack},
};

constexpr const Kind* by_mark[] = {
    &kinds::step,  &kinds::iges, &kinds::ifc,   &kinds::ole,    &kinds::rhino,   &kinds::dwg,   &kinds::x3d,
    &kinds::blend, &kinds::dae,  &kinds::usd,   &kinds::max3ds, &kinds::alembic, &kinds::off,   &kinds::draco,
    &kinds::amf,   &kinds::dcm,  &kinds::nifti, &kinds::nrrd,   &kinds::meta,    &kinds::vtk,   &kinds::vdb,
    &kinds::las,   &kinds::e57,  &kinds::pcd,   &kinds::zip,    &kinds::rar,     &kinds::seven, &kinds::gzip,
    &kinds::xz,    &kinds::bzip, &kinds::zstd,  &kinds::tar,    &kinds::svg,     &kinds::pdf,   &kinds::eps,
    &kinds::heic,  &kinds::avif, &kinds::jxl,   &kinds::jp2,    &kinds::xcf,     &kinds::dds,   &kinds::ktx,
    &kinds::film,  &kinds::html, &kinds::lfs,   &kinds::xml,    &kinds::zeros,   &kinds::job};

/// Bytes at a place that no other kind has there.
struct Mark {
    const Kind* kind;
    std::string_view bytes;
    std::size_t at = 0;
};
constexpr Mark marks[] = {
    {&kinds::step, "ISO-10303-21"sv},
    {&kinds::ole, "\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"sv},
    {&kinds::rhino, "3D Geometry File Format"sv},
    {&kinds::dwg, "AC10"sv},
    {&kinds::x3d, "#X3D"sv},
    {&kinds::blend, "BLENDER"sv},
    {&kinds::usd, "PXR-USDC"sv},
    {&kinds::usd, "#usda"sv},
    {&kinds::alembic, "Ogawa"sv},
    {&kinds::off, "OFF"sv},
    {&kinds::off, "COFF"sv},
    {&kinds::off, "NOFF"sv},
    {&kinds::off, "STOFF"sv},
    {&kinds::draco, "DRACO"sv},
    {&kinds::dcm, "DICM"sv, 128},
    {&kinds::nifti, "n+1\0"sv, 344},
    {&kinds::nifti, "ni1\0"sv, 344},
    {&kinds::nifti, "n+2\0"sv, 4},
    {&kinds::nrrd, "NRRD000"sv},
    {&kinds::meta, "ObjectType = Image"sv},
    {&kinds::vtk, "# vtk DataFile"sv},
    {&kinds::vdb, " BDV\0\0\0\0"sv},
    {&kinds::las, "LASF"sv},
    {&kinds::e57, "ASTM-E57"sv},
    {&kinds::pcd, "# .PCD"sv},
    {&kinds::rar, "Rar!\x1a\x07"sv},
    {&kinds::seven, "7z\xbc\xaf\x27\x1c"sv},
    {&kinds::gzip, "\x1f\x8b\x08"sv},
    {&kinds::xz, "\xfd\x37zXZ\0"sv},
    {&kinds::bzip, "BZh"sv},
    {&kinds::zstd, "\x28\xb5\x2f\xfd"sv},
    {&kinds::tar, "ustar"sv, 257},
    {&kinds::pdf, "%PDF"sv},
    {&kinds::eps, "%!PS"sv},
    {&kinds::eps, "\xc5\xd0\xd3\xc6"sv},
    {&kinds::avif, "ftypavi"sv, 4},
    {&kinds::heic, "ftypheic"sv, 4},
    {&kinds::heic, "ftypheix"sv, 4},
    {&kinds::heic, "ftyphevc"sv, 4},
    {&kinds::heic, "ftypheim"sv, 4},
    {&kinds::heic, "ftypmif1"sv, 4},
    {&kinds::heic, "ftypmsf1"sv, 4},
    {&kinds::film, "ftyp"sv, 4},
    {&kinds::film, "\x1a\x45\xdf\xa3"sv},
    {&kinds::film, "AVI LIST"sv, 8},
    {&kinds::jxl, "\xff\x0a"sv},
    {&kinds::jxl, "\0\0\0\x0cJXL "sv},
    {&kinds::jp2, "\0\0\0\x0cjP  "sv},
    {&kinds::jp2, "\xff\x4f\xff\x51"sv},
    {&kinds::xcf, "gimp xcf"sv},
    {&kinds::dds, "DDS "sv},
    {&kinds::ktx, "\xabKTX"sv},
    {&kinds::sent, "404: Not Found"sv},
    {&kinds::sent, "404 Not Found"sv},
    {&kinds::sent, "Not Found"sv},
    {&kinds::lfs, "version https://git-lfs"sv},
};

/// Root elements of XML.
constexpr Mark roots[] = {{&kinds::dae, "COLLADA"sv}, {&kinds::amf, "amf"sv},     {&kinds::x3d, "x3d"sv},
                          {&kinds::svg, "svg"sv},     {&kinds::vtk, "VTKFile"sv}, {&kinds::html, "html"sv},
                          {&kinds::sent, "Error"sv}};

/// What can be read, by its first bytes: its name's end, and how it is called.
struct Readable {
    std::string_view ending, what, bytes;
    std::size_t at = 0;
};
constexpr Readable pictures[] = {{"png", "a PNG picture", "\x89PNG\r\n\x1a\n"sv},
                                 {"jpg", "a JPEG picture", "\xff\xd8\xff"sv},
                                 {"gif", "a GIF picture", "GIF8"sv},
                                 {"webp", "a WebP picture", "WEBP"sv, 8},
                                 {"tif", "a TIFF picture", "II*\0"sv},
                                 {"tif", "a TIFF picture", "MM\0*"sv},
                                 {"exr", "an EXR picture", "\x76\x2f\x31\x01"sv},
                                 {"hdr", "a Radiance picture", "#?RADIANCE"sv},
                                 {"bmp", "a BMP picture", "BM"sv},
                                 {"psd", "a Photoshop picture", "8BPS"sv}};

bool has(std::string_view text, std::string_view bytes, std::size_t at) {
    return text.size() >= at && text.substr(at).starts_with(bytes);
}

bool is_word_of(std::string_view list, std::string_view word) {
    for (std::size_t at = 0; at < list.size();) {
        const std::size_t end = std::min(list.find(' ', at), list.size());
        if (list.substr(at, end - at) == word) return true;
        at = end + 1;
    }
    return false;
}

/// "a.nii.gz" -> "nii.gz", then "gz".
std::vector<std::string> endings_of(const std::string& name) {
    std::vector<std::string> endings;
    const std::string lower = lower_case(name);
    for (std::size_t dot = lower.find('.'); dot != lower.npos; dot = lower.find('.', dot + 1))
        endings.push_back(lower.substr(dot + 1));
    return endings;
}

const Kind* kind_by_name(const std::string& name) {
    for (const std::string& ending : endings_of(name)) {
        for (const Kind* kind : by_mark)
            if (is_word_of(kind->endings, ending)) return kind;
        for (const Kind& kind : by_name)
            if (is_word_of(kind.endings, ending)) return &kind;
    }
    return nullptr;
}

const Kind* kind_of_xml(std::string_view text) {
    const std::string_view plain = behind_blanks(text);
    if (lower_case(plain.substr(0, 14)) == "<!doctype html") return &kinds::html;
    const std::string_view root = root_element(text);
    for (const Mark& mark : roots)
        if (!root.empty() && lower_case(root) == lower_case(mark.bytes)) return mark.kind;
    return plain.starts_with("<?xml") && !root.empty() ? &kinds::xml : nullptr;
}

/// The first line of an IGES file has 80 columns, the last of which count the lines of its start section.
bool is_iges(std::string_view text) { return text.size() > 80 && text.substr(72, 8) == "S      1"; }

/// "MM" and the length of the file.
bool is_3ds(std::string_view text, std::uintmax_t size) {
    if (text.size() < 6 || !text.starts_with("MM")) return false;
    std::uint32_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) length |= std::uint32_t{static_cast<unsigned char>(text[2 + i])} << (8 * i);
    return length == size;
}

/// By the names of parts in its beginning, where documents of offices have others.
bool is_3mf(std::string_view text) {
    const auto holds = [&](std::string_view name) { return text.find(name) != text.npos; };
    if (holds("3dmodel.model")) return true;
    return holds("[Content_Types].xml") && !holds("word/") && !holds("ppt/") && !holds("xl/");
}

/// By the name of the first part: archives of models may hold a package as a part.
bool begins_as_3mf(std::string_view text) {
    constexpr std::size_t name_at = 30;
    const std::string_view first = text.substr(std::min(name_at, text.size()));
    return first.starts_with("3D/") || first.starts_with("[Content_Types].xml") || first.starts_with("_rels/");
}

/// What an archive holds, by the names in its beginning.
const Kind* kind_of_zip(std::string_view text) {
    if (is_3mf(text)) return nullptr;
    const std::string_view first = text.size() > 30 ? text.substr(30, 256) : std::string_view();
    for (const std::string_view inner : {".usdc"sv, ".usda"sv, ".usd"sv})
        if (first.find(inner) != first.npos) return &kinds::usd;
    return &kinds::zip;
}

const Kind* kind_by_content(const std::string& name, std::string_view text, std::uintmax_t size) {
    if (text.starts_with("PK\x03\x04")) return kind_of_zip(text);
    if (is_3ds(text, size)) return &kinds::max3ds;
    const std::string_view plain = text.starts_with("\xef\xbb\xbf") ? text.substr(3) : text;
    for (const Mark& mark : marks)
        if (has(text, mark.bytes, mark.at) || (mark.at == 0 && plain.starts_with(mark.bytes)))
            return mark.kind == &kinds::step && text.find("IFC") != text.npos ? &kinds::ifc : mark.kind;
    if (is_iges(plain)) return &kinds::iges;
    if (const Kind* kind = kind_of_xml(text)) return kind;
    if (plain.starts_with('{') && text.find("voxtone-job") != text.npos) return &kinds::job;
    if ((plain.starts_with('{') || plain.starts_with('[')) && is_model_name(name) && extension_of(name) != "gltf" &&
        text.find("\"asset\"") == text.npos)
        return &kinds::sent;  // JSON
    constexpr std::size_t least_zeros = 512;
    const bool only_zeros = text.find_first_not_of('\0') == text.npos;
    return only_zeros && text.size() >= least_zeros ? &kinds::zeros : nullptr;
}

/// A line "v 1 2 3".
bool has_vertex_line(std::string_view text) {
    if (text.find('\0') != text.npos) return false;
    TextLines lines(text);
    bool comma = false;
    while (const auto line = lines.next()) {
        std::string_view words = *line;
        if (cut_word(words) != "v") continue;
        for (int i = 0; i < 3; ++i)
            if (!number_of(cut_word(words), comma)) return false;
        return true;
    }
    return false;
}

bool is_binary_stl(std::string_view text, std::uintmax_t size) {
    if (text.size() <= 84) return false;
    std::uint64_t count = 0;
    for (std::size_t i = 0; i < 4; ++i) count |= std::uint64_t{static_cast<unsigned char>(text[80 + i])} << (8 * i);
    return count > 0 && size == 84 + 50 * count;
}

struct ModelKind {
    std::string_view ending, what, other;  ///< another ending of the same
};

/// A model that can be read; nothing where the bytes do not tell.
const ModelKind* model_by_content(std::string_view text, std::uintmax_t size) {
    static constexpr ModelKind glb{"glb", "a GLB model", "gltf"}, gltf{"gltf", "a glTF model", "glb"},
        ply{"ply", "a PLY model", ""}, threemf{"3mf", "a 3MF model", ""}, stl{"stl", "an STL model", ""},
        obj{"obj", "an OBJ model", ""}, fbx{"fbx", "an FBX model", ""}, vrml{"wrl", "a VRML model", "vrml"};
    if (text.starts_with("glTF")) return &glb;
    if (text.starts_with("ply\n") || text.starts_with("ply\r")) return &ply;
    if (text.starts_with("PK\x03\x04")) return kind_of_zip(text) ? nullptr : &threemf;
    const std::string_view plain = behind_blanks(text);
    if (text.starts_with("Kaydara FBX") || plain.starts_with("; FBX")) return &fbx;
    if (plain.starts_with("#VRML")) return &vrml;
    if (plain.starts_with('{') && text.find("\"asset\"") != text.npos) return &gltf;
    if (lower_case(plain.substr(0, 5)) == "solid" && lower_case(text).find("facet") != text.npos) return &stl;
    if (is_binary_stl(text, size)) return &stl;
    return has_vertex_line(text) ? &obj : nullptr;
}

const Readable* picture_by_content(std::string_view text) {
    for (const Readable& picture : pictures)
        if (has(text, picture.bytes, picture.at)) return &picture;
    return nullptr;
}

std::string refusal(const std::string& name, const Kind& kind, Wanted wanted, bool in_spite_of_name) {
    return fmt::format(
        "{} is {}{}, and {} that can be read: {}", name, kind.what, in_spite_of_name ? ", whatever its name says" : "",
        wanted != Wanted::model_or_picture ? "no picture" : "neither a model nor a picture", kind.remedy);
}

std::string stem_of(const std::string& name) { return std::filesystem::path(name).stem().string(); }

}  // namespace

std::string foreign_kind(const std::string& name, std::span<const std::byte> beginning, std::uintmax_t size,
                         Wanted wanted) {
    const std::string_view text(reinterpret_cast<const char*>(beginning.data()), beginning.size());
    const Kind* const named = kind_by_name(name);
    const std::string extension = extension_of(name);
    if (named && named->inside == Inside::picture) return refusal(name, *named, wanted, false);
    if (extension == "stl" && is_binary_stl(text, size)) return {};  // whatever its header says
    const bool is_archive = extension == "zip" && wanted == Wanted::model_or_picture;
    if (is_archive && text.starts_with("PK") && !begins_as_3mf(text)) return {};  // its reader knows what is in it
    if (extension == "3mf" && text.starts_with("PK")) return {};                  // its parser knows what is in it
    if (is_vrml_name(name) && text.starts_with("\x1f\x8b")) return {};            // packed by gzip, as it may be
    const bool may_be_drawn = wanted != Wanted::texture && !is_model_name(name);
    if (may_be_drawn && extension == "svgz" && text.starts_with("\x1f\x8b")) return {};
    if (const Readable* const picture = picture_by_content(text)) {
        if (wanted != Wanted::model_or_picture || !is_model_name(name)) return {};
        return fmt::format(
            "{} is {} by its first bytes and no model: rename it {}.{} to print it as a picture, or give "
            "the model",
            name, picture->what, stem_of(name), picture->ending);
    }
    if (const Kind* const kind = kind_by_content(name, text, size)) {
        if (kind == &kinds::svg && may_be_drawn) return {};
        const bool packed = kind == &kinds::zip || kind == &kinds::gzip;
        const bool as_named =
            named && (kind == named || named->remedy == kind->remedy || (packed && named->inside == Inside::anything));
        const bool in_spite = !as_named && (named || is_model_name(name) || is_picture_name(name));
        return refusal(name, as_named ? *named : *kind, wanted, in_spite);
    }
    if (const ModelKind* const model = model_by_content(text, size)) {
        if (wanted != Wanted::model_or_picture) return fmt::format("{} is {} and no picture", name, model->what);
        if (extension == model->ending || (!extension.empty() && extension == model->other)) return {};
        if (model->ending == "wrl" && is_vrml_name(name)) return {};
        return fmt::format("{} is {} by its first bytes, and models are known by their names: rename it {}.{}", name,
                           model->what, stem_of(name), model->ending);
    }
    if (named == &kinds::svg && may_be_drawn) return {};  // its reader says what is wrong with it
    return named && !is_archive ? refusal(name, *named, wanted, false) : std::string();
}

std::string foreign_kind(const std::filesystem::path& file, Wanted wanted) {
    std::vector<std::byte> bytes;
    std::uintmax_t size = 0;
    std::error_code error;
    if (std::filesystem::is_regular_file(file, error)) {
        size = std::filesystem::file_size(file, error);
        std::ifstream in(file, std::ios::binary);
        bytes.resize(kind_bytes);
        in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        bytes.resize(in.bad() ? 0 : static_cast<std::size_t>(in.gcount()));
    }
    return foreign_kind(file.filename().string(), bytes, size, wanted);
}

}  // namespace voxtone::io
