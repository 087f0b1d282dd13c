// SPDX-License-Identifier: GPL-3.0-or-later
//
// A real browser without a window, driven over the pipe of its debugging protocol: real keys and pointers, and all that
// the page says on the console or asks the network for.
#pragma once

#include <sys/types.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace voxtone::test {

/// The program's name, or empty where there is none on this machine.
[[nodiscard]] std::string find_chromium();

class Chromium {
public:
    explicit Chromium(std::vector<std::string> flags = {});
    ~Chromium();
    Chromium(const Chromium&) = delete;
    Chromium& operator=(const Chromium&) = delete;

    /// Opens the file in a tab of its own, which nothing is left in of the page before, and waits until the page's
    /// script says that all is unpacked, or `seconds` have passed. How long its first picture took, in seconds of the
    /// browser's own clock, from the start of the navigation; NaN: none came.
    double open(const std::filesystem::path& page, int width = 1400, int height = 900, double seconds = 60);
    [[nodiscard]] nlohmann::json evaluate(const std::string& expression);
    /// Until the expression is true.
    bool wait_for(const std::string& expression, double seconds = 20);
    /// Two frames, so that what was asked for is drawn.
    void draw();

    void move(double x, double y);
    void drag(double x, double y, double to_x, double to_y);
    void click(double x, double y);
    /// Fingers on a touch screen go from places to others; as many as there are places.
    void touch(const std::vector<std::array<double, 2>>& from, const std::vector<std::array<double, 2>>& to);
    void wheel(double x, double y, double by);
    /// "light" or "dark", as the user's system prefers.
    void prefer(const std::string& scheme);
    /// "screen" or "print": the page is laid out for it.
    void prefer_media(const std::string& media);
    /// As KeyboardEvent.key names it: "a", " ", "ArrowLeft", "Tab".
    void key(const std::string& name);
    /// Of an element: left, top, width, height.
    [[nodiscard]] std::array<double, 4> box(const std::string& selector);

    /// The window's contents.
    [[nodiscard]] std::vector<std::uint8_t> screenshot();
    [[nodiscard]] std::array<std::uint8_t, 3> pixel(double x, double y);
    [[nodiscard]] std::size_t printed_pages();

    /// Of the page that is open: messages of the console, exceptions, entries of the log.
    [[nodiscard]] const std::vector<std::string>& complaints() const { return complaints_; }
    /// Whatever was asked for but the page itself and data in it.
    [[nodiscard]] const std::vector<std::string>& requests() const { return requests_; }

private:
    nlohmann::json call(const std::string& method, nlohmann::json parameters = nlohmann::json::object());
    void new_tab();
    void hear(const nlohmann::json& event);
    [[nodiscard]] std::string next_message();
    void pointer(const char* type, double x, double y, const char* button, int buttons);

    std::filesystem::path profile_;
    pid_t child_ = -1;
    int to_ = -1, from_ = -1, calls_ = 0;
    std::string received_, target_, session_, page_url_;
    std::vector<std::string> complaints_, requests_;
};

/// One browser for all tests of a program: to start one takes longer than most pages are looked at.
[[nodiscard]] Chromium& shared_chromium();

}  // namespace voxtone::test
