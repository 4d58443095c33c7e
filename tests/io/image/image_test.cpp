// Pictures read back as they were written, and hostile ones do no harm.
#include "io/image/image.h"

#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include <gmock/gmock.h>
#include <turbojpeg.h>

#include "io/core/random.h"
#include "tests/io/io_testing.h"

namespace lucarne::io {
namespace {

using testing::MemoryFile;
using testing::read_bytes;
using testing::TemporaryFolder;
using testing::write_bytes;

Image noise(uint32_t width, uint32_t height) {
    Image image{width, height, {}};
    Random random(7);
    for (size_t i = 0; i < size_t{width} * height; ++i) {
        const auto value = [&] { return static_cast<float>(std::exp(20 * random.uniform() - 10)); };
        image.pixels.emplace_back(value(), value(), value(), static_cast<float>(random.uniform()));
    }
    return image;
}

Image8 noise8(uint32_t width, uint32_t height) {
    Image8 image{width, height, {}};
    Random random(8);
    for (size_t i = 0; i < size_t{3} * width * height; ++i)
        image.bytes.push_back(static_cast<uint8_t>(random.next()));
    return image;
}

TEST(Exr, FloatsComeBackBitForBit) {
    const TemporaryFolder folder;
    const Image image = noise(37, 21);
    ASSERT_TRUE(write_exr(folder / "a.exr", image, false, true));
    const auto back = read_exr(folder / "a.exr");
    ASSERT_TRUE(back) << back.error().line();
    EXPECT_EQ(back->width, 37u);
    EXPECT_EQ(back->height, 21u);
    EXPECT_TRUE(back->pixels == image.pixels);
}

TEST(Exr, TheDescriptionOfTheSurfacesComesBack) {
    const TemporaryFolder folder;
    Image image = noise(3, 2);
    ASSERT_TRUE(write_exr(folder / "a.exr", image, false));
    image.surfaces = "points 1 pixels apart";
    ASSERT_TRUE(write_exr(folder / "b.exr", image, false));
    const auto unknown = read_exr(folder / "a.exr"), known = read_exr(folder / "b.exr");
    ASSERT_TRUE(unknown && known);
    EXPECT_EQ(unknown->surfaces, "");
    EXPECT_EQ(known->surfaces, image.surfaces);
}

TEST(Exr, WithoutAlphaOpacityIsOne) {
    const TemporaryFolder folder;
    const Image image = noise(3, 2);
    ASSERT_TRUE(write_exr(folder / "a.exr", image, false));
    const auto back = read_exr(folder / "a.exr");
    ASSERT_TRUE(back) << back.error().line();
    for (size_t i = 0; i < 6; ++i) {
        EXPECT_EQ(back->pixels[i].y, image.pixels[i].y);
        EXPECT_EQ(back->pixels[i].w, 1.0f);
    }
}

TEST(Exr, NonFiniteRadianceIsNotHidden) {
    const TemporaryFolder folder;
    Image image = noise(2, 1);
    image.pixels[0].x = std::numeric_limits<float>::infinity();
    image.pixels[1].z = std::numeric_limits<float>::quiet_NaN();
    ASSERT_TRUE(write_exr(folder / "a.exr", image, false));
    const auto back = read_exr(folder / "a.exr");
    ASSERT_TRUE(back);
    EXPECT_TRUE(std::isinf(back->pixels[0].x));
    EXPECT_TRUE(std::isnan(back->pixels[1].z));
}

TEST(Png, BytesComeBackAsTheyWere) {
    const TemporaryFolder folder;
    const Image8 image = noise8(41, 13);
    ASSERT_TRUE(write_png(folder / "a.png", image, false));
    const auto back = read_png(folder / "a.png");
    ASSERT_TRUE(back) << back.error().line();
    EXPECT_EQ(back->width, 41u);
    EXPECT_TRUE(back->bytes == image.bytes);
}

TEST(Pictures, AnExistingFileIsKeptUnlessOverwritten) {
    const TemporaryFolder folder;
    write_bytes(folder / "a.png", "mine");
    write_bytes(folder / "a.exr", "mine");
    EXPECT_FALSE(write_png(folder / "a.png", noise8(2, 2), false));
    EXPECT_FALSE(write_exr(folder / "a.exr", noise(2, 2), false));
    EXPECT_EQ(read_bytes(folder / "a.png"), "mine");
    EXPECT_EQ(read_bytes(folder / "a.exr"), "mine");
    EXPECT_TRUE(write_png(folder / "a.png", noise8(2, 2), true));
    EXPECT_TRUE(write_exr(folder / "a.exr", noise(2, 2), true));
    EXPECT_TRUE(read_png(folder / "a.png"));
    EXPECT_TRUE(read_exr(folder / "a.exr"));
}

TEST(Pictures, APictureWhoseSizeIsALieIsNotWritten) {
    const TemporaryFolder folder;
    Image image = noise(2, 2);
    image.height = 3;
    EXPECT_FALSE(write_exr(folder / "a.exr", image, false));
    EXPECT_FALSE(write_png(folder / "a.png", Image8{5, 5, {1, 2, 3}}, false));
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

/// Big-endian, as in PNG.
void put_u32(std::string& bytes, size_t at, uint32_t value) {
    for (size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<char>(value >> (24 - 8 * i));
}

TEST(Pictures, HugeSizesInAHeaderAreRejectedBeforeAllocation) {
    const TemporaryFolder folder;
    ASSERT_TRUE(write_png(folder / "a.png", noise8(4, 4), false));
    ASSERT_TRUE(write_exr(folder / "a.exr", noise(4, 4), false));
    std::string png = read_bytes(folder / "a.png");
    put_u32(png, 16, 900'000);
    put_u32(png, 20, 900'000);  // the checksum is wrong then as well; both must give a clean error
    write_bytes(folder / "b.png", png);
    EXPECT_EQ(read_png(folder / "b.png").error().kind, ErrorKind::input_rejected);

    std::string exr = read_bytes(folder / "a.exr");
    const size_t window = exr.find("dataWindow") + 11 + 6 + 4;  // name, type "box2i", size
    const int32_t huge[] = {0, 0, 0x7ffffff0, 0x7ffffff0};
    std::memcpy(&exr[window], huge, sizeof huge);
    write_bytes(folder / "b.exr", exr);
    EXPECT_EQ(read_exr(folder / "b.exr").error().kind, ErrorKind::input_rejected);
}

std::string refusal_of_exr(const std::string& bytes) {
    const MemoryFile file;
    file.set(bytes);
    const auto read = read_exr(file.path());
    return read ? "read" : read.error().line();
}

/// A picture of 4x4 pixels, and the place of the size of an attribute of `name` and `type` in it.
class ExrHeader : public ::testing::Test {
 protected:
    void SetUp() override {
        const TemporaryFolder folder;
        ASSERT_TRUE(write_exr(folder / "a.exr", noise(4, 4), false));
        bytes_ = read_bytes(folder / "a.exr");
    }
    size_t value_of(const std::string& name, const std::string& type) const {
        return bytes_.find(name + '\0' + type + '\0') + name.size() + type.size() + 2 + 4;
    }
    /// Inserts an attribute before all others.
    void insert(const std::string& name, const std::string& type, const std::string& value) {
        const auto size = static_cast<uint32_t>(value.size());
        bytes_.insert(
            8, name + '\0' + type + '\0' + std::string(reinterpret_cast<const char*>(&size), 4) + value);
    }
    template <class T>
    void put(size_t at, T value) {
        std::memcpy(&bytes_[at], &value, sizeof value);
    }
    std::string bytes_;
};

TEST(Exr, WhatIsNoneIsCalledThat) {
    for (const char* bytes : {"", "hello", "a text that is longer than a header of EXR has to be"})
        EXPECT_THAT(refusal_of_exr(bytes), ::testing::EndsWith(": is no EXR picture"));
}

TEST_F(ExrHeader, AnAttributeLargerThanTheFileIsRefusedBeforeItIsMadeRoomFor) {
    insert("comments", "unheard", "1234");
    EXPECT_THAT(refusal_of_exr(bytes_), ::testing::HasSubstr("data block"))
        << "the pixels are moved, no more";
    put(value_of("comments", "unheard") - 4, uint32_t{1'677'918'208});
    EXPECT_THAT(refusal_of_exr(bytes_), ::testing::HasSubstr("header is cut off"));
}

/// The library reads a list of channels to its own end, and takes what follows as the next attribute
/// (fuzz_exr).
TEST_F(ExrHeader, AnAttributeThatDoesNotEndWhereItSaysIsRefused) {
    const std::string whole = bytes_;
    insert("more", "chlist", std::string("A\0", 2) + std::string(16, '\1') + "B");
    EXPECT_THAT(refusal_of_exr(bytes_), ::testing::HasSubstr("contradicts itself"));
    bytes_ = whole;
    insert("more", "v2f", std::string(12, '\1'));
    EXPECT_THAT(refusal_of_exr(bytes_), ::testing::HasSubstr("contradicts itself"));
}

/// Pixel (0, 0) of such a window would lie outside of all memory, so no pointer to it may be formed
/// (fuzz_exr).
TEST_F(ExrHeader, AWindowFarFromTheOriginIsReadAsAnyOther) {
    size_t chunk = 8;  // the only chunk, right after the table that says where it is
    while (chunk < bytes_.size() && std::memcmp(&bytes_[chunk - 8], &chunk, 8) != 0) ++chunk;
    for (const std::array<int32_t, 2> corner :
         {std::array{-1'000'000'000, 1'000'000'000}, {909'522'486, -7}}) {
        put(value_of("dataWindow", "box2i"), std::array{corner[0], corner[1], corner[0] + 3, corner[1] + 3});
        put(chunk, corner[1]);
        const MemoryFile file;
        file.set(bytes_);
        const auto read = read_exr(file.path());
        ASSERT_TRUE(read) << read.error().line();
        const Image image = noise(4, 4);
        for (size_t i = 0; i < 16; ++i) EXPECT_EQ(glm::vec3(read->pixels[i]), glm::vec3(image.pixels[i]));
    }
}

TEST_F(ExrHeader, LinesThatTheFileHasNoTableForAreRefused) {
    for (const std::array<int32_t, 2> corner : {std::array{16383, 4000}, {3, 16383}}) {
        put(value_of("dataWindow", "box2i") + 8, corner);
        EXPECT_THAT(refusal_of_exr(bytes_), ::testing::HasSubstr("table of its chunks"));
    }
}

TEST_F(ExrHeader, TilesThatTheFileHasNoTableForAreRefused) {
    insert("tiles", "tiledesc", std::string("\1\0\0\0\1\0\0\0\0", 9));
    put(value_of("dataWindow", "box2i") + 8, std::array{4000, 4000});
    EXPECT_THAT(refusal_of_exr(bytes_), ::testing::HasSubstr("table of its chunks"));
    put(value_of("tiles", "tiledesc"), 0);
    EXPECT_THAT(refusal_of_exr(bytes_), ::testing::HasSubstr("tiles are empty"));
}

TEST_F(ExrHeader, OtherPromisesOfMemoryAreRefused) {
    const std::string whole = bytes_;
    insert("chunkCount", "int", std::string("\xff\xff\xff\x7f", 4));
    EXPECT_THAT(refusal_of_exr(bytes_), ::testing::HasSubstr("table of its chunks"));
    bytes_ = whole;
    insert("preview", "preview", std::string("\0\x40\0\0\0\x40\0\0", 8));
    EXPECT_THAT(refusal_of_exr(bytes_), ::testing::HasSubstr("preview"));
    bytes_ = whole;
    insert("ids", "idmanifest", std::string("\xff\xff\xff\x7f\0\0\0\0", 8));
    EXPECT_THAT(refusal_of_exr(bytes_), ::testing::HasSubstr("identifiers"));
}

TEST(Exr, MoreLinesThanAreReadAtOnceComeBackBitForBit) {
    const TemporaryFolder folder;
    const Image image = noise(3, 700);
    ASSERT_TRUE(write_exr(folder / "a.exr", image, false, true));
    const auto back = read_exr(folder / "a.exr");
    ASSERT_TRUE(back) << back.error().line();
    EXPECT_TRUE(back->pixels == image.pixels);
}

/// The checksum of PNG (ISO 15948, annex D).
uint32_t png_checksum(std::string_view bytes) {
    uint32_t sum = ~0u;
    for (const char byte : bytes) {
        sum ^= static_cast<uint8_t>(byte);
        for (int bit = 0; bit < 8; ++bit) sum = sum & 1 ? 0xedb88320u ^ sum >> 1 : sum >> 1;
    }
    return ~sum;
}

TEST(Png, MorePixelsThanItsBytesCanHoldAreRefusedBeforeTheyAreMadeRoomFor) {
    const TemporaryFolder folder;
    ASSERT_TRUE(write_png(folder / "a.png", noise8(4, 4), false));
    std::string png = read_bytes(folder / "a.png");
    put_u32(png, 16, 8000);
    put_u32(png, 20, 8000);
    put_u32(png, 29, png_checksum(std::string_view(png).substr(12, 17)));
    write_bytes(folder / "b.png", png);
    const auto read = read_png(folder / "b.png");
    ASSERT_FALSE(read);
    EXPECT_THAT(read.error().line(), ::testing::HasSubstr("shorter than its 8000x8000 pixels"));
}

/// Returns one slope in red and one in green as JPEG with this colour subsampling.
std::string slopes_jpeg(int width, int height, TJSAMP sampling) {
    std::vector<unsigned char> rgb;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (const int value : {255 * x / width, 255 * y / height, 60})
                rgb.push_back(static_cast<unsigned char>(value));
    const tjhandle encoder = tjInitCompress();
    unsigned char* bytes = nullptr;
    unsigned long size = 0;
    EXPECT_EQ(tjCompress2(encoder, rgb.data(), width, 0, height, TJPF_RGB, &bytes, &size, sampling, 95, 0),
              0);
    const std::string encoded(reinterpret_cast<const char*>(bytes), size);
    tjFree(bytes);
    tjDestroy(encoder);
    return encoded;
}

TEST(Jpeg, ColoursComeBackWhateverTheirSubsampling) {
    constexpr int kWidth = 61, kHeight = 43;  // no multiple of the block size
    for (const TJSAMP sampling : {TJSAMP_444, TJSAMP_422, TJSAMP_420, TJSAMP_GRAY}) {
        const MemoryFile file;
        file.set(slopes_jpeg(kWidth, kHeight, sampling));
        const auto read = read_jpeg(file.path());
        ASSERT_TRUE(read) << read.error().line();
        ASSERT_TRUE(read->width == kWidth && read->height == kHeight &&
                    read->bytes.size() == 3 * kWidth * kHeight);
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                const uint8_t* pixel = &read->bytes[3 * (static_cast<size_t>(y) * kWidth + x)];
                const double red = 255 * x / kWidth, green = 255 * y / kHeight;
                if (sampling == TJSAMP_GRAY) {  // JFIF's luminance, the same in all three channels
                    EXPECT_NEAR(pixel[0], .299 * red + .587 * green + .114 * 60, 4);
                    EXPECT_TRUE(pixel[1] == pixel[0] && pixel[2] == pixel[0]);
                } else {
                    EXPECT_NEAR(pixel[0], red, 10) << x << " " << y;
                    EXPECT_NEAR(pixel[1], green, 10) << x << " " << y;
                    EXPECT_NEAR(pixel[2], 60, 14) << x << " " << y;
                }
            }
    }
}

TEST(Jpeg, OneThatIsNotWholeOrNoneIsRefusedOrReadAndNeverCrashes) {
    const std::string whole = slopes_jpeg(64, 48, TJSAMP_420);
    size_t refused = 0;
    for (size_t length = 0; length < whole.size(); ++length) {
        const MemoryFile file;
        file.set(std::string_view(whole).substr(0, length));
        const auto read = read_jpeg(file.path());
        refused += !read;
        if (!read) {
            EXPECT_EQ(read.error().kind, ErrorKind::input_rejected);
        } else {
            EXPECT_EQ(read->bytes.size(), 3u * 64 * 48);
        }
    }
    EXPECT_GT(refused, 20u) << "not even the start of it is needed";
}

TEST(Jpeg, MorePixelsThanItsBytesCanHoldAreRefusedBeforeTheyAreMadeRoomFor) {
    const MemoryFile file;
    // Start, a frame of 8000x8000 grey pixels, the start of its scan.
    file.set(
        std::string("\xff\xd8\xff\xc0\0\x0b\x08\x1f\x40\x1f\x40\1\1\x11\0\xff\xda\0\x08\1\1\0\0\x3f\0", 25));
    const auto read = read_jpeg(file.path());
    ASSERT_FALSE(read);
    EXPECT_THAT(read.error().line(), ::testing::HasSubstr("shorter than its 8000x8000 pixels"));
}

TEST(Pictures, TruncatedAndChangedFilesNeverCrash) {
    const TemporaryFolder folder;
    ASSERT_TRUE(write_png(folder / "a.png", noise8(9, 9), false));
    ASSERT_TRUE(write_exr(folder / "a.exr", noise(9, 9), false));
    const MemoryFile file;
    const std::string png = read_bytes(folder / "a.png"), exr = read_bytes(folder / "a.exr");
    for (size_t length = 0; length < png.size(); length += 7) {
        file.set(png.substr(0, length));
        (void)read_png(file.path());
    }
    for (size_t length = 0; length + 1 < exr.size(); length += 7) {
        file.set(exr.substr(0, length));
        EXPECT_FALSE(read_exr(file.path())) << length;
    }
    Random random(3);
    for (int round = 0; round < 500; ++round) {
        std::string p = png, e = exr;
        p[random.next() % p.size()] = static_cast<char>(random.next());
        e[random.next() % std::min<size_t>(400, e.size())] = static_cast<char>(random.next());
        file.set(p);
        (void)read_png(file.path());
        file.set(e);
        (void)read_exr(file.path());
    }
}

TEST(Pictures, WhatIsNoPictureIsRejectedWithItsName) {
    const TemporaryFolder folder;
    write_bytes(folder / "text", "not a picture");
    write_bytes(folder / "empty", "");
    for (const char* name : {"text", "empty", "missing"}) {
        const auto png = read_png(folder / name);
        const auto exr = read_exr(folder / name);
        ASSERT_FALSE(png);
        ASSERT_FALSE(exr);
        EXPECT_EQ(png.error().kind, ErrorKind::input_rejected);
        EXPECT_EQ(exr.error().kind, ErrorKind::input_rejected);
        EXPECT_THAT(png.error().line(), ::testing::HasSubstr(name));
        EXPECT_THAT(exr.error().line(), ::testing::HasSubstr(name));
    }
}

}  // namespace
}  // namespace lucarne::io
