#include "gi/scene/colour_map.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/common.hpp>

namespace lucarne::gi {
namespace {

constexpr size_t kSteps = 33;

constexpr glm::vec3 colour_of(uint32_t code) {
    return glm::vec3(static_cast<float>(code >> 16), static_cast<float>(code >> 8 & 255u),
                     static_cast<float>(code & 255u)) /
           255.0f;
}

// Every 8th of the 256 colours of Matplotlib 3.10. mapped_colour() interpolates between them linearly, with
// an error of at most .024. viridis, magma: van der Walt & Smith 2015. cividis: Nunez, Anderton & Renslow
// 2018. turbo: Mikhailov 2019. cool_warm: Moreland 2009, "Diverging color maps for scientific
// visualization".
constexpr uint32_t kTables[][kSteps] = {
    // viridis
    {
        0x440154, 0x470d60, 0x48186a, 0x482374, 0x472d7b, 0x453781, 0x424086, 0x3e4989, 0x3b528b,
        0x375b8d, 0x33638d, 0x2f6b8e, 0x2c728e, 0x297a8e, 0x26828e, 0x23898e, 0x21918c, 0x1f988b,
        0x1fa088, 0x22a785, 0x28ae80, 0x32b67a, 0x3fbc73, 0x4ec36b, 0x5ec962, 0x70cf57, 0x84d44b,
        0x98d83e, 0xaddc30, 0xc2df23, 0xd8e219, 0xece51b, 0xfde725,
    },
    // cividis
    {
        0x00224e, 0x00285b, 0x002e6a, 0x053371, 0x1a386f, 0x273e6e, 0x32436d, 0x3b496c, 0x434e6c,
        0x4b546c, 0x535a6d, 0x5a5f6e, 0x61656f, 0x686a71, 0x6f7073, 0x767676, 0x7d7c78, 0x848279,
        0x8c8878, 0x938e78, 0x9b9476, 0xa39a74, 0xaba072, 0xb4a76f, 0xbcae6c, 0xc4b468, 0xcdbb63,
        0xd5c25e, 0xdec958, 0xe7d150, 0xf0d846, 0xf9e03a, 0xfee838,
    },
    // magma
    {
        0x000004, 0x030312, 0x0a0822, 0x130d34, 0x1d1147, 0x29115a, 0x36106b, 0x440f76, 0x51127c,
        0x5d177f, 0x6a1c81, 0x762181, 0x832681, 0x902a81, 0x9c2e7f, 0xaa337d, 0xb73779, 0xc43c75,
        0xd0416f, 0xdc4869, 0xe75263, 0xef5d5e, 0xf56b5c, 0xf9795d, 0xfc8961, 0xfd9869, 0xfea772,
        0xfeb67c, 0xfec488, 0xfed395, 0xfde2a3, 0xfcf0b2, 0xfcfdbf,
    },
    // turbo
    {
        0x30123b, 0x392a73, 0x4040a2, 0x4456c7, 0x466be3, 0x4680f6, 0x4294ff, 0x37a8fa, 0x28bceb,
        0x1ccdd8, 0x18ddc2, 0x1fe9af, 0x32f298, 0x4ef97d, 0x6dfe62, 0x8bff4b, 0xa4fc3c, 0xb9f635,
        0xcdec34, 0xdfdf37, 0xeecf3a, 0xf8be39, 0xfdac34, 0xfe962b, 0xfb7e21, 0xf46617, 0xeb500e,
        0xdf3f08, 0xd02f05, 0xbe2102, 0xa91601, 0x920b01, 0x7a0403,
    },
    // cool_warm
    {
        0x3b4cc0, 0x445acc, 0x4e68d8, 0x5875e1, 0x6282ea, 0x6c8ff1, 0x779af7, 0x82a6fb, 0x8db0fe,
        0x98b9ff, 0xa3c2fe, 0xaec9fc, 0xb9d0f9, 0xc3d5f4, 0xccd9ed, 0xd5dbe5, 0xdddcdc, 0xe5d8d1,
        0xecd3c5, 0xf1ccb8, 0xf5c4ac, 0xf7ba9f, 0xf7b093, 0xf6a586, 0xf4987a, 0xf08b6e, 0xeb7d62,
        0xe46e56, 0xdd5f4b, 0xd44e41, 0xca3b37, 0xbe242e, 0xb40426,
    },
};

// The specification names classes and leaves their colours to programs. These are the colours that most
// programs use: ground brown, vegetation green, buildings red, water blue, noise magenta.
constexpr ClassLook kClasses[] = {
    {0, "Never classified", colour_of(0x9a9a9a)},
    {1, "Unclassified", colour_of(0xbababa)},
    {2, "Ground", colour_of(0xa87848)},
    {3, "Low vegetation", colour_of(0xb5d96c)},
    {4, "Medium vegetation", colour_of(0x6fbf4b)},
    {5, "High vegetation", colour_of(0x2a8a3a)},
    {6, "Building", colour_of(0xe0523e)},
    {7, "Low noise", colour_of(0xff00ff)},
    {8, "Model key-point", colour_of(0xffb300)},
    {9, "Water", colour_of(0x3c8fe0)},
    {10, "Rail", colour_of(0x7d5fb2)},
    {11, "Road surface", colour_of(0x5f6470)},
    {12, "Overlap", colour_of(0xe6d34a)},
    {13, "Wire, guard", colour_of(0xfff27a)},
    {14, "Wire, conductor", colour_of(0xffd21f)},
    {15, "Transmission tower", colour_of(0xb88a00)},
    {16, "Wire-structure connector", colour_of(0xff9d5c)},
    {17, "Bridge deck", colour_of(0xc9a9e6)},
    {18, "High noise", colour_of(0xff5cc8)},
    {19, "Overhead structure", colour_of(0x8fa7c4)},
    {20, "Ignored ground", colour_of(0xd9c2a3)},
    {21, "Snow", colour_of(0xf4faff)},
    {22, "Temporal exclusion", colour_of(0x4a4a4a)},
};

// Okabe & Ito 2008, "Color universal design", without black, followed by lighter and darker colours.
constexpr uint32_t kOrdinals[] = {0xe69f00, 0x56b4e9, 0x009e73, 0xf0e442, 0x0072b2, 0xd55e00,
                                  0xcc79a7, 0xb3b3b3, 0xf5cf7f, 0x004d38, 0xa8d8f4, 0x6b2f00};

}  // namespace

std::span<const std::string_view> colour_map_names() {
    static constexpr std::array<std::string_view, 6> kNames = {"viridis", "cividis",   "magma",
                                                               "turbo",   "cool-warm", "grey"};
    return kNames;
}

glm::vec3 mapped_colour(ColourMap map, double place) {
    const double at = place > 0 ? std::min(place, 1.0) : 0.0;  // NaN: 0
    if (map == ColourMap::grey) return glm::vec3(static_cast<float>(at));
    const auto& table = kTables[static_cast<size_t>(map)];
    const double steps = at * (kSteps - 1);
    const size_t below = std::min(static_cast<size_t>(steps), kSteps - 2);
    return glm::mix(colour_of(table[below]), colour_of(table[below + 1]),
                    static_cast<float>(steps - static_cast<double>(below)));
}

std::span<const ClassLook> named_classes() {
    return kClasses;
}

std::string_view class_name(uint8_t number) {
    if (number < std::size(kClasses)) return kClasses[number].name;
    return number < 64 ? "Reserved" : "User class";
}

glm::vec3 class_colour(uint8_t number) {
    return number < std::size(kClasses) ? kClasses[number].colour : ordinal_colour(number);
}

glm::vec3 ordinal_colour(uint64_t number) {
    return colour_of(kOrdinals[number % std::size(kOrdinals)]);
}

}  // namespace lucarne::gi
