// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/io/report/chromium.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <map>
#include <span>
#include <stdexcept>

#include "io/files/base64.h"
#include "io/pictures/png_pixels.h"

namespace voxtone::test {

namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr int answer_within_ms = 60'000;

/// Clear of the descriptors 3 and 4 that the browser takes its messages from.
int moved_away(int descriptor) {
    const int moved = fcntl(descriptor, F_DUPFD, 10);
    close(descriptor);
    return moved;
}

[[noreturn]] void become_browser(const std::string& program, const std::vector<std::string>& flags, int in, int out) {
    setpgid(0, 0);
    dup2(in, 3);
    dup2(out, 4);
    const int nowhere = ::open("/dev/null", O_RDWR);
    for (const int standard : {0, 1, 2}) dup2(nowhere, standard);
    std::vector<char*> arguments{const_cast<char*>(program.c_str())};
    for (const std::string& flag : flags) arguments.push_back(const_cast<char*>(flag.c_str()));
    arguments.push_back(nullptr);
    execvp(program.c_str(), arguments.data());
    _exit(127);
}

}  // namespace

std::string find_chromium() {
    for (const char* folder : {"/usr/bin/", "/usr/local/bin/", "/snap/bin/"})
        for (const char* name : {"chromium", "chromium-browser", "google-chrome"})
            if (access((std::string(folder) + name).c_str(), X_OK) == 0) return std::string(folder) + name;
    return {};
}

Chromium::Chromium(std::vector<std::string> flags) {
    std::string folder = (fs::temp_directory_path() / "voxtone-browser-XXXXXX").string();
    if (!mkdtemp(folder.data())) throw std::runtime_error("no folder for the browser");
    profile_ = folder;
    // The tests may run as root and in a container, without a GPU and with a small /dev/shm.
    for (const char* flag : {"--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--no-first-run",
                             "--disable-background-networking", "--use-angle=swiftshader",
                             "--enable-unsafe-swiftshader", "--remote-debugging-pipe"})
        flags.emplace_back(flag);
    flags.push_back("--user-data-dir=" + folder);
    flags.emplace_back("about:blank");
    int to[2], from[2];
    if (pipe(to) != 0 || pipe(from) != 0) throw std::runtime_error("no pipe to the browser");
    for (int* end : {&to[0], &to[1], &from[0], &from[1]}) *end = moved_away(*end);
    const std::string program = find_chromium();
    child_ = fork();
    if (child_ == 0) become_browser(program, flags, to[0], from[1]);
    close(to[0]);
    close(from[1]);
    to_ = to[1];
    from_ = from[0];
}

void Chromium::new_tab() {
    session_.clear();  // what follows is said to the browser
    if (!target_.empty()) call("Target.closeTarget", {{"targetId", target_}});
    target_ = call("Target.createTarget", {{"url", "about:blank"}})["targetId"];
    session_ = call("Target.attachToTarget", {{"targetId", target_}, {"flatten", true}})["sessionId"];
    complaints_.clear();
    requests_.clear();
    for (const char* domain : {"Page", "Runtime", "Log", "Network"}) call(std::string(domain) + ".enable");
}

Chromium::~Chromium() {
    close(to_);
    close(from_);
    kill(-child_, SIGKILL);
    waitpid(child_, nullptr, 0);
    std::error_code left;
    fs::remove_all(profile_, left);
}

std::string Chromium::next_message() {
    for (;;) {
        if (const std::size_t end = received_.find('\0'); end != received_.npos) {
            std::string message = received_.substr(0, end);
            received_.erase(0, end + 1);
            return message;
        }
        pollfd wait{from_, POLLIN, 0};
        if (poll(&wait, 1, answer_within_ms) <= 0) throw std::runtime_error("the browser does not answer");
        std::array<char, 1 << 16> buffer;
        const ssize_t count = read(from_, buffer.data(), buffer.size());
        if (count <= 0) throw std::runtime_error("the browser has ended");
        received_.append(buffer.data(), std::size_t(count));
    }
}

void Chromium::hear(const json& event) {
    if (event.value("sessionId", "") != session_) return;  // of a page before
    const std::string method = event.value("method", "");
    const json& about = event["params"];
    if (method == "Runtime.consoleAPICalled" || method == "Runtime.exceptionThrown" || method == "Log.entryAdded")
        complaints_.push_back(about.dump());
    if (method == "Network.requestWillBeSent") {
        const std::string url = about["request"]["url"];
        if (url != page_url_ && !url.starts_with("data:") && !url.starts_with("blob:")) requests_.push_back(url);
    }
}

json Chromium::call(const std::string& method, json parameters) {
    const int id = ++calls_;
    json message{{"id", id}, {"method", method}, {"params", std::move(parameters)}};
    if (!session_.empty()) message["sessionId"] = session_;
    const std::string text = message.dump() + '\0';
    for (std::size_t sent = 0; sent < text.size();) {
        const ssize_t count = write(to_, text.data() + sent, text.size() - sent);
        if (count <= 0) throw std::runtime_error("the browser does not listen");
        sent += std::size_t(count);
    }
    for (;;) {
        const json answer = json::parse(next_message());
        if (answer.value("id", 0) != id) {
            if (answer.contains("method")) hear(answer);
            continue;
        }
        if (answer.contains("error")) throw std::runtime_error(method + ": " + answer["error"].dump());
        return answer["result"];
    }
}

json Chromium::evaluate(const std::string& expression) {
    const json answer =
        call("Runtime.evaluate", {{"expression", expression}, {"awaitPromise", true}, {"returnByValue", true}});
    if (answer.contains("exceptionDetails")) throw std::runtime_error(expression + ": " + answer.dump());
    return answer["result"].value("value", json());
}

bool Chromium::wait_for(const std::string& expression, double seconds) {
    const auto begin = std::chrono::steady_clock::now();
    while (!evaluate("Boolean(" + expression + ")").get<bool>()) {
        if (std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count() > seconds) return false;
        draw();
    }
    return true;
}

void Chromium::draw() {
    (void)evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(true))))");
}

double Chromium::open(const fs::path& page, int width, int height, double seconds) {
    new_tab();
    call("Emulation.setDeviceMetricsOverride",
         {{"width", width}, {"height", height}, {"deviceScaleFactor", 1}, {"mobile", false}});
    page_url_ = "file://" + page.string();
    call("Page.navigate", {{"url", page_url_}});
    wait_for("document.readyState === 'complete'", seconds);
    wait_for("document.documentElement.dataset.ready", seconds);
    const json shown = evaluate("Number(document.documentElement.dataset.shown) / 1000");
    return shown.is_number() ? shown.get<double>() : std::nan("");
}

void Chromium::pointer(const char* type, double x, double y, const char* button, int buttons) {
    call("Input.dispatchMouseEvent",
         {{"type", type}, {"x", x}, {"y", y}, {"button", button}, {"buttons", buttons}, {"clickCount", 1}});
}

void Chromium::move(double x, double y) {
    pointer("mouseMoved", x, y, "none", 0);
    draw();
}

void Chromium::drag(double x, double y, double to_x, double to_y) {
    constexpr int steps = 6;
    pointer("mouseMoved", x, y, "none", 0);
    pointer("mousePressed", x, y, "left", 1);
    for (int i = 1; i <= steps; ++i)
        pointer("mouseMoved", x + (to_x - x) * i / steps, y + (to_y - y) * i / steps, "left", 1);
    pointer("mouseReleased", to_x, to_y, "left", 0);
    draw();
}

void Chromium::click(double x, double y) {
    pointer("mouseMoved", x, y, "none", 0);
    pointer("mousePressed", x, y, "left", 1);
    pointer("mouseReleased", x, y, "left", 0);
    draw();
}

void Chromium::touch(const std::vector<std::array<double, 2>>& from, const std::vector<std::array<double, 2>>& to) {
    constexpr int steps = 5;
    for (int i = 0; i <= steps; ++i) {
        json points = json::array();
        for (std::size_t p = 0; p < from.size(); ++p)
            points.push_back({{"x", from[p][0] + (to[p][0] - from[p][0]) * i / steps},
                              {"y", from[p][1] + (to[p][1] - from[p][1]) * i / steps},
                              {"id", p}});
        call("Input.dispatchTouchEvent", {{"type", i == 0 ? "touchStart" : "touchMove"}, {"touchPoints", points}});
    }
    call("Input.dispatchTouchEvent", {{"type", "touchEnd"}, {"touchPoints", json::array()}});
    draw();
}

void Chromium::wheel(double x, double y, double by) {
    call("Input.dispatchMouseEvent", {{"type", "mouseWheel"}, {"x", x}, {"y", y}, {"deltaX", 0}, {"deltaY", by}});
    draw();
}

void Chromium::key(const std::string& name) {
    json down{{"type", "keyDown"}, {"key", name}, {"code", name}};
    if (name.size() == 1) down["text"] = name;
    // Tab, space and Enter do what the browser does with them only with their codes.
    const std::map<std::string, int> codes{{"Tab", 9}, {"Enter", 13}, {" ", 32}, {"End", 35}, {"Home", 36}};
    if (const auto code = codes.find(name); code != codes.end()) down["windowsVirtualKeyCode"] = code->second;
    if (name == "Enter") down["text"] = "\r";
    call("Input.dispatchKeyEvent", down);
    down["type"] = "keyUp";
    down.erase("text");
    call("Input.dispatchKeyEvent", down);
    draw();
}

void Chromium::prefer(const std::string& scheme) {
    call("Emulation.setEmulatedMedia",
         {{"features", json::array({{{"name", "prefers-color-scheme"}, {"value", scheme}}})}});
    draw();
}

void Chromium::prefer_media(const std::string& media) {
    call("Emulation.setEmulatedMedia", {{"media", media}});
    draw();
}

std::array<double, 4> Chromium::box(const std::string& selector) {
    const json box = evaluate("(() => { const b = document.querySelector(" + json(selector).dump() +
                              ").getBoundingClientRect(); return [b.left, b.top, b.width, b.height]; })()");
    return box.get<std::array<double, 4>>();
}

std::vector<std::uint8_t> Chromium::screenshot() {
    const std::vector<std::byte> bytes =
        io::base64_bytes(call("Page.captureScreenshot", {{"format", "png"}})["data"].get<std::string>());
    const auto* first = reinterpret_cast<const std::uint8_t*>(bytes.data());
    return {first, first + bytes.size()};
}

std::array<std::uint8_t, 3> Chromium::pixel(double x, double y) {
    const std::vector<std::uint8_t> png = screenshot();
    std::array<std::uint8_t, 3> rgb{};
    io::read_png(png, "a screenshot", [&](std::uint32_t row, std::span<const std::uint8_t> rgba) {
        if (row != std::uint32_t(y)) return;
        for (std::size_t c = 0; c < 3; ++c) rgb[c] = rgba[4 * std::size_t(x) + c];
    });
    return rgb;
}

std::size_t Chromium::printed_pages() {
    // A4 in inches.
    const json printed =
        call("Page.printToPDF", {{"paperWidth", 8.27}, {"paperHeight", 11.69}, {"printBackground", true}});
    const std::vector<std::byte> bytes = io::base64_bytes(printed["data"].get<std::string>());
    const std::string pdf(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    std::size_t pages = 0;
    for (std::size_t at = pdf.find("/Type /Page"); at != pdf.npos; at = pdf.find("/Type /Page", at + 1))
        if (pdf[at + 11] != 's') ++pages;
    return pages;
}

Chromium& shared_chromium() {
    static Chromium browser;
    return browser;
}

}  // namespace voxtone::test
