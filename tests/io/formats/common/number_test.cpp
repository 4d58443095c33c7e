// Decimal numbers become the nearest double and the nearest float, both on the fast path and on the slow one.
#include <cstdlib>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "io/core/random.h"
#include "io/formats/common/text.h"

namespace lucarne::io {
namespace {

/// Compares with the C library, which rounds correctly.
void expect_nearest(const std::string& text) {
    const auto wide = parse_number<double>(text);
    const auto narrow = parse_number<float>(text);
    ASSERT_TRUE(wide && narrow) << text;
    EXPECT_EQ(std::bit_cast<uint64_t>(*wide), std::bit_cast<uint64_t>(std::strtod(text.c_str(), nullptr)))
        << text;
    EXPECT_EQ(std::bit_cast<uint32_t>(*narrow), std::bit_cast<uint32_t>(std::strtof(text.c_str(), nullptr)))
        << text;
}

TEST(Numbers, AreTheNearestDoubleAndTheNearestFloat) {
    Random random(1);
    for (int i = 0; i < 200'000; ++i) {
        std::string digits = std::to_string(random.next() >> random.next() % 64);
        if (const size_t place = random.next() % 25; place < digits.size()) digits.insert(place, 1, '.');
        if (random.next() % 2) digits.insert(0, 1, '-');
        if (random.next() % 8 == 0) digits += fmt::format("e{}", static_cast<int>(random.next() % 40) - 20);
        expect_nearest(digits);
    }
}

TEST(Numbers, HalfwayBetweenTwoFloatsAreNotRoundedTwice) {
    // The doubles nearest to these numbers lie halfway between two floats, but the numbers do not.
    for (const char* text :
         {"1.0000000596046448", "1.0000000596046447", "1.00000017881393433", "16777217.000000001",
          "16777216.999999999", "-1.0000000596046448", "0.500000029802322399"})
        expect_nearest(text);
    Random random(2);
    for (int i = 0; i < 50'000; ++i) {
        const auto bits = static_cast<uint32_t>(random.next() % 0x10000000 + 0x38000000);  // from 3e-5 to 1e5
        const double halfway =
            (double{std::bit_cast<float>(bits)} + double{std::bit_cast<float>(bits + 1)}) / 2;
        for (const int digits : {9, 12, 15, 16, 17, 18})
            expect_nearest(fmt::format("{:.{}f}", halfway, digits));
    }
}

TEST(Numbers, WhatIsOddlyWrittenIsReadOrRefusedAsEver) {
    for (const char* text : {"0", "-0", "0.0", "-.5", "5.", "0.000000000000000001", "9007199254740993",
                             "123456789012345678901234567890", "1e-50", "1e50", "1E+5"})
        expect_nearest(text);
    EXPECT_EQ(parse_number<double>("+1.5"), 1.5);
    for (const char* text :
         {"", "-", "+", ".", "-.", "+-1", "-+1", "1.2.3", "1,5", "0x10", "1e", "e5", "--1", "1 "})
        EXPECT_FALSE(parse_number<double>(text) || parse_number<float>(text)) << text;
}

}  // namespace
}  // namespace lucarne::io
