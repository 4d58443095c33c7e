#include "io/input/controller.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <libusb.h>

#include "io/core/guarded.h"
#include "io/core/log.h"

namespace lucarne::io {
namespace {

constexpr uint16_t kLogitech = 0x046d, k3Dconnexion = 0x256f;
/// Products with Logitech's vendor id that are 6-DoF controllers; mice and keyboards have that id as well.
constexpr std::array<uint16_t, 11> kOfLogitech = {0xc603, 0xc605, 0xc606, 0xc621, 0xc623, 0xc625,
                                                  0xc626, 0xc627, 0xc628, 0xc629, 0xc62b};
constexpr int kScanSeconds = 2;  ///< between checks of the bus if nothing reports new devices
constexpr size_t kLongestReport = 64;
constexpr int kMostFailures = 8;  ///< failed transfers in a row before the device is given up

bool is_controller(const libusb_device_descriptor& device) {
    return device.idVendor == k3Dconnexion ||
           (device.idVendor == kLogitech &&
            std::ranges::find(kOfLogitech, device.idProduct) != kOfLogitech.end());
}

/// Finds the interface that reports axes: HID, and neither a mouse nor a keyboard (HID 1.11, 4.3). The same
/// receiver may serve these as well; they are left to the desktop.
struct Endpoint {
    uint8_t interface, address;
    uint16_t packet;
};
std::optional<Endpoint> find_endpoint(libusb_device* device) {
    libusb_config_descriptor* config = nullptr;
    if (libusb_get_active_config_descriptor(device, &config) != 0 || !config) return {};
    std::optional<Endpoint> found;
    for (uint8_t i = 0; i < config->bNumInterfaces && !found; ++i) {
        if (config->interface[i].num_altsetting < 1) continue;
        const libusb_interface_descriptor& interface = config->interface[i].altsetting[0];
        if (interface.bInterfaceClass != LIBUSB_CLASS_HID || interface.bInterfaceProtocol != 0) continue;
        for (uint8_t e = 0; e < interface.bNumEndpoints && !found; ++e) {
            const libusb_endpoint_descriptor& endpoint = interface.endpoint[e];
            if ((endpoint.bEndpointAddress & LIBUSB_ENDPOINT_IN) &&
                (endpoint.bmAttributes & 3) == LIBUSB_TRANSFER_TYPE_INTERRUPT)
                found = Endpoint{interface.bInterfaceNumber, endpoint.bEndpointAddress,
                                 std::clamp<uint16_t>(endpoint.wMaxPacketSize, 1, kLongestReport)};
        }
    }
    libusb_free_config_descriptor(config);
    return found;
}

std::string refusal(int error) {
    if (error == LIBUSB_ERROR_ACCESS)
        return "no permission to read it; put data/60-lucarne-controller.rules into /etc/udev/rules.d, run "
               "`udevadm "
               "control --reload` as root and plug it in again";
    if (error == LIBUSB_ERROR_BUSY)
        return "another program holds it; end that one (spacenavd, 3DxWare) first";
    return libusb_strerror(static_cast<libusb_error>(error));
}

}  // namespace

struct Controller::Reader {
    explicit Reader(std::function<void()> on_change) : changed(std::move(on_change)) {}

    void run();
    void read_reports(bool told);
    void look_for_devices();
    int open(libusb_device* device, const Endpoint& endpoint);
    int claim(uint8_t interface);
    void close();
    void set(const SixDofState& state_now);
    void set(ControllerStatus status_now);
    static void take_transfer(libusb_transfer* transfer);
    static int arrived(libusb_context*, libusb_device*, libusb_hotplug_event, void* self);

    std::function<void()> changed;
    libusb_context* usb = nullptr;
    std::thread thread;
    std::atomic<bool> ending = false;

    // Only the reading thread uses these.
    bool look = true;      ///< something may have been plugged in
    bool unlucky = false;  ///< the device disappeared or did not answer: look for it again after a while
    libusb_device_handle* handle = nullptr;
    uint8_t interface = 0;
    libusb_transfer* transfer = nullptr;
    bool flying = false;  ///< libusb has the transfer
    bool lost = false;
    int failures = 0;
    std::array<unsigned char, kLongestReport> buffer{};

    mutable std::mutex mutex;
    SixDofState state;
    ControllerStatus status;
    uint32_t pressed = 0;
};

void Controller::Reader::set(const SixDofState& now) {
    {
        const std::lock_guard lock(mutex);
        if (state == now) return;
        pressed |= now.buttons & ~state.buttons;
        state = now;
    }
    changed();
}

void Controller::Reader::set(ControllerStatus now) {
    {
        const std::lock_guard lock(mutex);
        if (status == now) return;
        if (now.kind == ControllerStatus::Kind::refused) log::warn("{}: {}", now.name, now.message);
        status = std::move(now);
    }
    changed();
}

void Controller::Reader::take_transfer(libusb_transfer* done) {
    auto& reader = *static_cast<Reader*>(done->user_data);
    reader.flying = false;
    if (done->status == LIBUSB_TRANSFER_COMPLETED) {
        reader.failures = 0;
        SixDofState next = reader.state;  // only this thread writes it
        if (take_report(
                std::as_bytes(std::span(reader.buffer).first(static_cast<size_t>(done->actual_length))),
                next))
            reader.set(next);
    } else if (done->status == LIBUSB_TRANSFER_NO_DEVICE || ++reader.failures > kMostFailures) {
        reader.lost = true;
        return;
    }
    if (reader.ending) return;
    if (libusb_submit_transfer(done) == 0)
        reader.flying = true;
    else
        reader.lost = true;
}

int Controller::Reader::arrived(libusb_context*, libusb_device*, libusb_hotplug_event, void* self) {
    static_cast<Reader*>(self)->look = true;  // opening the device here would hang libusb
    return 0;
}

int Controller::Reader::claim(uint8_t of) {
    libusb_set_auto_detach_kernel_driver(handle, 1);  // and reattach it afterwards
    const int claimed = libusb_claim_interface(handle, of);
    if (claimed == 0) return 0;
    libusb_set_auto_detach_kernel_driver(handle, 0);
    return libusb_claim_interface(handle, of) == 0 ? 0 : claimed;
}

int Controller::Reader::open(libusb_device* device, const Endpoint& endpoint) {
    if (const int opened = libusb_open(device, &handle); opened != 0) return opened;
    int done = claim(endpoint.interface);
    if (done == 0) {
        interface = endpoint.interface;
        transfer = libusb_alloc_transfer(0);
        if (transfer) {
            libusb_fill_interrupt_transfer(transfer, handle, endpoint.address, buffer.data(), endpoint.packet,
                                           take_transfer, this, 0);
            done = libusb_submit_transfer(transfer);
            flying = done == 0;
        } else {
            done = LIBUSB_ERROR_NO_MEM;
        }
    }
    if (done != 0) close();
    return done;
}

void Controller::Reader::close() {
    if (flying) libusb_cancel_transfer(transfer);
    while (flying) {
        timeval moment{0, 100000};
        if (libusb_handle_events_timeout_completed(usb, &moment, nullptr) != 0) break;
    }
    if (transfer && !flying) libusb_free_transfer(transfer);
    if (handle) {
        libusb_release_interface(handle, interface);
        libusb_close(handle);
    }
    transfer = nullptr;
    handle = nullptr;
    lost = flying = false;
    failures = 0;
    set(SixDofState{});
}

void Controller::Reader::look_for_devices() {
    look = false;
    libusb_device** devices = nullptr;
    const ssize_t count = libusb_get_device_list(usb, &devices);
    ControllerStatus found;
    for (ssize_t i = 0; i < count && found.kind != ControllerStatus::Kind::connected; ++i) {
        libusb_device_descriptor of{};
        if (libusb_get_device_descriptor(devices[i], &of) != 0 || !is_controller(of)) continue;
        const auto endpoint = find_endpoint(devices[i]);
        if (!endpoint) continue;
        found.name = fmt::format("6-DoF controller {:04x}:{:04x}", of.idVendor, of.idProduct);
        const int opened = open(devices[i], *endpoint);
        found.kind = opened == 0 ? ControllerStatus::Kind::connected : ControllerStatus::Kind::refused;
        found.message = opened == 0 ? "" : refusal(opened);
    }
    if (count >= 0) libusb_free_device_list(devices, 1);
    set(std::move(found));
}

void Controller::Reader::run() {
    libusb_hotplug_callback_handle callback = 0;
    const bool told = libusb_has_capability(LIBUSB_CAP_HAS_HOTPLUG) &&
                      libusb_hotplug_register_callback(usb, LIBUSB_HOTPLUG_EVENT_DEVICE_ARRIVED, 0,
                                                       LIBUSB_HOTPLUG_MATCH_ANY, LIBUSB_HOTPLUG_MATCH_ANY,
                                                       LIBUSB_HOTPLUG_MATCH_ANY, arrived, this,
                                                       &callback) == LIBUSB_SUCCESS;
    const auto ended = guarded("6-DoF controller", [&] { read_reports(told); });
    if (told) libusb_hotplug_deregister_callback(usb, callback);
    close();
    if (!ended) set(ControllerStatus{ControllerStatus::Kind::refused, ended.error().what, ended.error().why});
}

/// Reads until told to end. `told` says that libusb reports new devices.
void Controller::Reader::read_reports(bool told) {
    using Clock = std::chrono::steady_clock;
    constexpr std::chrono::seconds kScan(kScanSeconds);
    auto next_look = Clock::now();
    while (!ending) {
        const bool due = Clock::now() >= next_look;
        if (!handle && (look || (due && (!told || unlucky)))) {
            unlucky = false;
            look_for_devices();
            next_look = Clock::now() + kScan;
        }
        timeval patience{kScanSeconds, 0};
        const int handled = libusb_handle_events_timeout_completed(usb, &patience, nullptr);
        if (handled != 0 && handled != LIBUSB_ERROR_INTERRUPTED) std::this_thread::sleep_for(kScan);
        if (lost) {
            close();
            set(ControllerStatus{});
            unlucky = true;
            next_look = Clock::now() + kScan;
        }
    }
}

Controller::Controller() = default;

std::unique_ptr<Controller> Controller::start(std::function<void()> changed) {
    std::unique_ptr<Controller> controller(new Controller);
    controller->reader_ = std::make_unique<Reader>(std::move(changed));
    Reader& reader = *controller->reader_;
    if (libusb_init(&reader.usb) != 0) {
        reader.usb = nullptr;  // no USB on this machine, so there will never be a device
        return controller;
    }
    reader.thread = std::thread([&reader] { reader.run(); });
    return controller;
}

Controller::~Controller() {
    if (!reader_->usb) return;
    reader_->ending = true;
    libusb_interrupt_event_handler(reader_->usb);
    reader_->thread.join();
    libusb_exit(reader_->usb);
}

SixDofState Controller::state() const {
    const std::lock_guard lock(reader_->mutex);
    return reader_->state;
}

ControllerStatus Controller::status() const {
    const std::lock_guard lock(reader_->mutex);
    return reader_->status;
}

uint32_t Controller::take_pressed() {
    const std::lock_guard lock(reader_->mutex);
    return std::exchange(reader_->pressed, 0);
}

}  // namespace lucarne::io
