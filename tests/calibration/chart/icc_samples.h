// SPDX-License-Identifier: GPL-3.0-or-later
//
// ICC profiles made of a formula by Little CMS: no vendor's profile is in the tree.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string>

#include <lcms2.h>
#include <catch2/catch.hpp>

namespace voxtone::calibration::testing {

using Inks = std::array<double, 4>;
using Formula = std::function<cmsCIELab(const Inks&)>;

// Straight in every ink, so that the profile's table of few nodes says it exactly.
inline cmsCIELab straight(const Inks& ink) {
    return {90 - 30 * ink[0] - 35 * ink[1] - 8 * ink[2] - 15 * ink[3], -20 * ink[0] + 40 * ink[1] - 4 * ink[2],
            -30 * ink[0] + 3 * ink[1] + 50 * ink[2]};
}

struct ProfileKind {
    cmsColorSpaceSignature space = cmsSigCmykData;
    cmsUInt32Number channels = 4;
    cmsProfileClassSignature of = cmsSigOutputClass;
    std::string measurements = {};
};

inline std::string profile_of(const ProfileKind& kind, const Formula& formula) {
    const std::unique_ptr<void, decltype([](void* p) { cmsCloseProfile(p); })> profile(
        cmsCreateProfilePlaceholder(nullptr));
    cmsSetProfileVersion(profile.get(), 2.4);  // whose tables may be a table alone
    cmsSetDeviceClass(profile.get(), kind.of);
    cmsSetColorSpace(profile.get(), kind.space);
    cmsSetPCS(profile.get(), cmsSigLabData);
    cmsWriteTag(profile.get(), cmsSigMediaWhitePointTag, cmsD50_XYZ());
    if (!kind.measurements.empty()) {
        const std::unique_ptr<cmsMLU, decltype([](cmsMLU* m) { cmsMLUfree(m); })> text(cmsMLUalloc(nullptr, 1));
        cmsMLUsetASCII(text.get(), cmsNoLanguage, cmsNoCountry, kind.measurements.c_str());
        cmsWriteTag(profile.get(), cmsSigCharTargetTag, text.get());
    }
    if (formula) {
        const std::unique_ptr<cmsPipeline, decltype([](cmsPipeline* p) { cmsPipelineFree(p); })> pipeline(
            cmsPipelineAlloc(nullptr, kind.channels, 3));
        cmsStage* const table = cmsStageAllocCLut16bit(nullptr, 5, kind.channels, 3, nullptr);
        struct Cargo {
            const Formula* formula;
            cmsUInt32Number channels;
        } cargo{&formula, kind.channels};
        cmsStageSampleCLut16bit(
            table,
            [](const cmsUInt16Number in[], cmsUInt16Number out[], void* data) -> cmsInt32Number {
                const Cargo& of = *static_cast<Cargo*>(data);
                Inks ink{};
                for (cmsUInt32Number c = 0; c < of.channels; ++c) ink[c] = in[c] / 65535.0;
                const cmsCIELab lab = (*of.formula)(ink);
                cmsFloat2LabEncodedV2(out, &lab);
                return 1;
            },
            &cargo, 0);
        cmsPipelineInsertStage(pipeline.get(), cmsAT_END, table);
        cmsWriteTag(profile.get(), cmsSigAToB1Tag, pipeline.get());
        cmsWriteTag(profile.get(), cmsSigAToB0Tag, pipeline.get());
    }
    cmsUInt32Number bytes = 0;
    REQUIRE(cmsSaveProfileToMem(profile.get(), nullptr, &bytes));
    std::string out(bytes, '\0');
    REQUIRE(cmsSaveProfileToMem(profile.get(), out.data(), &bytes));
    return out;
}

}  // namespace voxtone::calibration::testing
