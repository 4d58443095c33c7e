// OpenEXR pictures, read through Lucarne's own file classes and written to memory first, so that errors and
// file names are handled as everywhere else.
#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>

#include "io/core/terminal.h"
#include "io/files/file.h"
#include "io/image/exr_header.h"
#include "io/image/image.h"

namespace lucarne::io {
namespace {

/// A growing buffer as OpenEXR's output.
class MemoryOutput final : public Imf::OStream {
 public:
    MemoryOutput() : Imf::OStream("") {}
    void write(const char* data, int bytes) override {
        const auto count = static_cast<size_t>(bytes);
        if (at_ + count > data_.size()) data_.resize(at_ + count);
        std::memcpy(data_.data() + at_, data, count);
        at_ += count;
    }
    uint64_t tellp() override { return at_; }
    void seekp(uint64_t at) override { at_ = static_cast<size_t>(at); }
    std::string_view data() const { return data_; }

 private:
    std::string data_;
    size_t at_ = 0;
};

class FileInput final : public Imf::IStream {
 public:
    explicit FileInput(const ByteSource& file) : Imf::IStream(""), file_(file) {}
    bool read(char* out, int bytes) override {
        const auto wanted = std::as_writable_bytes(std::span(out, static_cast<size_t>(std::max(bytes, 0))));
        if (!file_.read_at(at_, wanted)) throw std::runtime_error("it ends early");
        at_ += wanted.size();
        return at_ < file_.size();
    }
    uint64_t tellg() override { return at_; }
    void seekg(uint64_t at) override { at_ = at; }

 private:
    const ByteSource& file_;
    uint64_t at_ = 0;
};

constexpr const char* kChannels[] = {"R", "G", "B", "A"};

constexpr const char* kSurfaces = "lucarneSurfaces";  ///< name of the attribute that holds Image::surfaces

constexpr size_t kMostReason = 120;    ///< bytes of the library's message
constexpr int64_t kLinesAtOnce = 256;  ///< the longest chunk

/// Reads lines from `line` on into `pixels`; the named channels become its components.
void read_lines(Imf::InputFile& exr, const std::vector<std::string>& names, int left, int64_t width, int line,
                int64_t lines, glm::vec4* pixels) {
    constexpr size_t kPixel = sizeof(glm::vec4);
    Imf::FrameBuffer target;
    for (size_t c = 0; c < names.size(); ++c)
        if (!names[c].empty())
            target.insert(names[c], Imf::Slice::Make(Imf::FLOAT, &(*pixels)[static_cast<glm::length_t>(c)],
                                                     {left, line}, width, lines, kPixel,
                                                     kPixel * static_cast<size_t>(width)));
    exr.setFrameBuffer(target);
    exr.readPixels(line, static_cast<int>(line + lines - 1));
}

Image decode(const ByteSource& file, uint64_t most_pixels) {
    // The library allocates by the header's size, so it must know the limit before it reads the header. The
    // setting is global in the library, but it is the same every time.
    Imf::Header::setMaxImageSize(kLargestSide, kLargestSide);
    FileInput stream(file);
    Imf::InputFile exr(stream, 0);
    const auto window = exr.header().dataWindow();
    const int64_t width = int64_t{window.max.x} - window.min.x + 1,
                  height = int64_t{window.max.y} - window.min.y + 1;
    const uint64_t most = std::min(most_pixels, kMostPixels);
    if (width < 1 || height < 1 || width > kLargestSide || height > kLargestSide ||
        static_cast<uint64_t>(width * height) > most)
        throw std::runtime_error(
            fmt::format("it has {}x{} pixels, which is too large: at most {} in all", width, height, most));

    const Imf::ChannelList& channels = exr.header().channels();
    const bool gray = channels.findChannel("R") == nullptr && channels.findChannel("Y") != nullptr;
    std::vector<std::string> names;  // channel of each component of a pixel; empty if missing
    for (size_t c = 0; c < 4; ++c) {
        names.emplace_back(gray && c < 3 ? (c == 0 ? "Y" : "") : kChannels[c]);
        if (names[c].empty()) continue;
        const Imf::Channel* channel = channels.findChannel(names[c]);
        if (!channel && c < 3) throw std::runtime_error("it lacks a channel R, G or B");
        if (!channel)
            names[c].clear();
        else if (channel->xSampling != 1 || channel->ySampling != 1)
            throw std::runtime_error("its channels are subsampled");
    }
    Image image{static_cast<uint32_t>(width), static_cast<uint32_t>(height), {}};
    if (const auto* text = exr.header().findTypedAttribute<Imf::StringAttribute>(kSurfaces))
        image.surfaces = shown(text->value(), kMostReason);
    // Memory grows with the data: a short file whose header promises many pixels fails at its first lines.
    for (int64_t line = 0; line < height; line += kLinesAtOnce) {
        const int64_t lines = std::min(kLinesAtOnce, height - line);
        image.pixels.resize(static_cast<size_t>(width * (line + lines)), glm::vec4(0, 0, 0, 1));
        read_lines(exr, names, window.min.x, width, static_cast<int>(window.min.y + line), lines,
                   image.pixels.data() + width * line);
    }
    if (gray)
        for (glm::vec4& p : image.pixels) p.y = p.z = p.x;
    return image;
}

void encode(const Image& image, bool alpha, MemoryOutput& out) {
    Imf::Header header(static_cast<int>(image.width), static_cast<int>(image.height));
    header.compression() = Imf::ZIP_COMPRESSION;
    if (!image.surfaces.empty()) header.insert(kSurfaces, Imf::StringAttribute(image.surfaces));
    Imf::FrameBuffer source;
    char* first = reinterpret_cast<char*>(const_cast<glm::vec4*>(image.pixels.data()));  // only read
    for (size_t c = 0; c < (alpha ? 4u : 3u); ++c) {
        header.channels().insert(kChannels[c], Imf::Channel(Imf::FLOAT));
        source.insert(kChannels[c], Imf::Slice(Imf::FLOAT, first + c * sizeof(float), sizeof(glm::vec4),
                                               sizeof(glm::vec4) * image.width));
    }
    Imf::OutputFile exr(out, header, 0);
    exr.setFrameBuffer(source);
    exr.writePixels(static_cast<int>(image.height));
}

}  // namespace

Result<void> write_exr(const std::filesystem::path& path, const Image& image, bool overwrite, bool alpha) {
    const std::string name = path.string();
    if (image.width == 0 || image.height == 0 || image.width > kLargestSide || image.height > kLargestSide ||
        image.pixels.size() != size_t{image.width} * image.height)
        return failed(name, fmt::format("no picture of {}x{} can be written", image.width, image.height));
    MemoryOutput encoded;
    try {
        encode(image, alpha, encoded);
    } catch (const std::exception& error) {
        return failed(name, fmt::format("cannot be encoded as EXR ({})", shown(error.what(), kMostReason)));
    }
    return write_file(path, encoded.data(), overwrite);
}

Result<Image> read_exr(const std::filesystem::path& path, uint64_t most_pixels) {
    LUCARNE_ASSIGN(const auto file, InputFile::open(path));
    LUCARNE_TRY(check_exr_header(file));
    try {
        return decode(file, most_pixels);
    } catch (const std::exception& error) {
        return rejected(path.string(),
                        fmt::format("is no usable EXR picture ({})", shown(error.what(), kMostReason)));
    }
}

}  // namespace lucarne::io
