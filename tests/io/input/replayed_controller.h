// A 3Dconnexion device that umockdev plays: its description, and what it sent, in usbmon's format.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace lucarne::io::test {

inline constexpr const char* kControllerPath = "/sys/devices/pci0000:00/0000:00:14.0/usb1/1-9";

/// A device's answer to a request for input: a report, or the error that ends the replay (-19: unplugged).
struct Answer {
    std::vector<uint8_t> report;
    int32_t status = 0;
    int64_t after_ms = 10;
};

inline std::vector<uint8_t> axes_report(uint8_t number, int16_t a, int16_t b, int16_t c) {
    std::vector<uint8_t> bytes = {number};
    for (const int16_t v : {a, b, c}) {
        bytes.push_back(static_cast<uint8_t>(v & 0xff));
        bytes.push_back(static_cast<uint8_t>(static_cast<uint16_t>(v) >> 8));
    }
    return bytes;
}

/// A SpaceNavigator (046d:c626), USB 2.0 chapter 9 descriptors: one HID interface, endpoint 0x81, 7 bytes.
inline void write_description(const std::filesystem::path& file) {
    const std::string device = "12010002000000086d0426c6000001020001";
    const std::string configuration = "09022200010100a031";
    const std::string interface =
        "0904000001030000"
        "00";
    const std::string hid =
        "0921110100012200"
        "00";
    const std::string endpoint = "0705810307000a";
    std::ofstream(file) << "P: /devices/pci0000:00/0000:00:14.0/usb1/1-9\n"
                           "N: bus/usb/001/004\n"
                           "E: BUSNUM=001\nE: DEVNAME=/dev/bus/usb/001/004\nE: DEVNUM=004\n"
                           "E: DEVTYPE=usb_device\nE: MAJOR=189\nE: MINOR=3\nE: SUBSYSTEM=usb\n"
                           "A: bConfigurationValue=1\\n\nA: busnum=1\\n\nA: devnum=4\\n\n"
                           "A: idVendor=046d\\n\nA: idProduct=c626\\n\nA: speed=12\\n\n"
                           "H: descriptors="
                        << device << configuration << interface << hid << endpoint << "\n\n";
}

/// A capture by usbmon (link type 220; the kernel's Documentation/usb/usbmon.rst): one submitted and one
/// completed interrupt transfer for each answer.
inline void write_capture(const std::filesystem::path& file, const std::vector<Answer>& answers) {
    std::string bytes;
    const auto put = [&](auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
    put(uint32_t{0xa1b2c3d4}), put(uint16_t{2}), put(uint16_t{4}), put(int32_t{0}), put(uint32_t{0});
    put(uint32_t{65535}), put(uint32_t{220});
    int64_t ms = 1000;
    uint64_t id = 1;
    const auto packet = [&](char type, const Answer& answer) {
        const bool done = type == 'C';
        const auto data = static_cast<uint32_t>(done ? answer.report.size() : 0);
        put(static_cast<uint32_t>(ms / 1000)), put(static_cast<uint32_t>(ms % 1000 * 1000));
        put(uint32_t{64} + data), put(uint32_t{64} + data);
        put(id), put(type), put(uint8_t{1}), put(uint8_t{0x81}), put(uint8_t{4}), put(uint16_t{1});
        put('-'), put(done && data ? '\0' : '<');
        put(int64_t{ms / 1000}), put(static_cast<int32_t>(ms % 1000 * 1000));
        put(done ? answer.status : int32_t{-115});  // -EINPROGRESS
        put(done ? data : uint32_t{7}), put(data);
        put(uint64_t{0}), put(int32_t{8}), put(int32_t{0}), put(uint32_t{0}), put(uint32_t{0});
        if (done) bytes.append(answer.report.begin(), answer.report.end());
    };
    for (const Answer& answer : answers) {
        packet('S', answer);
        ms += answer.after_ms;
        packet('C', answer);
        ++id;
    }
    std::ofstream(file, std::ios::binary) << bytes;
}

/// Returns the words to put before a program's command line, so that it sees the device.
inline std::vector<std::string> under_umockdev(const std::filesystem::path& folder,
                                               const std::vector<Answer>& answers) {
    const auto description = folder / "controller.umockdev", capture = folder / "controller.pcap";
    write_description(description);
    write_capture(capture, answers);
    return {"env",
            "ASAN_OPTIONS=verify_asan_link_order=0",  // umockdev's library is loaded before the sanitizers'
            "umockdev-run",
            "--device",
            description.string(),
            "--pcap",
            fmt::format("{}={}", kControllerPath, capture.string()),
            "--"};
}

}  // namespace lucarne::io::test
