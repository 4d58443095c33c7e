#include "gi/scene/sun.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace lucarne::gi {
namespace {

SolarPosition position(const std::string& time, double latitude, double longitude) {
    SunMoment sun;
    sun.latitude = latitude, sun.longitude = longitude, sun.time = parse_time(time).value();
    return solar_position(sun);
}

TEST(Sun, StandsWhereTheSolarPositionAlgorithmsPublishedExampleHasIt) {
    // Reda & Andreas 2004, NREL/TP-560-34302, appendix A.5: Golden, Colorado; without refraction.
    const auto sun = position("2003-10-17T12:30:30-07:00", 39.742476, -105.1786);
    EXPECT_NEAR(sun.elevation, 39.872046, 0.01);
    EXPECT_NEAR(sun.azimuth, 194.34024, 0.01);
}

TEST(Sun, AtThePoleItIsAsHighAsItsPublishedDeclination) {
    // Meeus 1998, example 25.a: 1992 October 13 at 0 h, apparent declination -7 degrees 47 minutes 06
    // seconds.
    EXPECT_NEAR(position("1992-10-13T00:00:00Z", 90, 0).elevation, -7.785, 0.002);
    // Equinoxes and solstices of 2024 from astronomical almanacs. Their declinations are by definition 0 and
    // the obliquity of the ecliptic, which was 23.438 degrees then.
    EXPECT_NEAR(position("2024-03-20T03:06:00Z", 90, 0).elevation, 0, 0.002);
    EXPECT_NEAR(position("2024-06-20T20:51:00Z", 90, 0).elevation, 23.438, 0.003);
    EXPECT_NEAR(position("2024-12-21T09:20:00Z", 90, 0).elevation, -23.438, 0.003);
}

TEST(Sun, CrossesTheMeridianAtGreenwichByTheEquationOfTime) {
    // From almanacs: solar noon is 16 min 26 s before clock noon early in November, 14 min 13 s after it on
    // 11 February.
    EXPECT_NEAR(position("2025-11-03T11:43:34Z", 51.4769, 0).azimuth, 180, 0.05);
    EXPECT_NEAR(position("2025-02-11T12:14:13Z", 51.4769, 0).azimuth, 180, 0.05);
}

TEST(Sun, ShinesFromTheSouthAtNoonAndTurnsWithTheScansNorth) {
    const auto to = towards({180, 30}, 0);
    EXPECT_NEAR(to.y, -std::sqrt(.75), 1e-12);
    EXPECT_NEAR(to.z, .5, 1e-12);
    EXPECT_NEAR(towards({180, 0}, 90).x, -1, 1e-12);
}

TEST(Time, IsWrittenAsItWasRead) {
    for (const char* text : {"2026-06-21T12:00:00+02:00", "1999-12-31T23:59:59Z", "2000-02-29T00:00:00-03:30",
                             "1900-01-01T00:00:00Z", "2100-12-31T23:59:59+14:00"}) {
        const auto moment = parse_time(text);
        ASSERT_TRUE(moment) << text;
        EXPECT_EQ(time_text(*moment), text);
        EXPECT_EQ(moment_of(local_time(*moment), moment->ahead), *moment);
    }
    EXPECT_EQ(parse_time("1970-01-02T01:00+01:00").value().seconds, 86400);
}

TEST(Time, ThatIsNoneIsRefused) {
    for (const char* text :
         {"", "2026", "2026-06-21", "2026-02-29T12:00:00Z", "2026-13-01T12:00:00Z", "2026-06-21T24:00:00Z",
          "2026-06-21T12:00:00", "2026-06-21T12:00:60Z", "2026-06-21T12:00:00+2:00",
          "2026-06-21T12:00:00Zebra", "1899-06-21T12:00:00Z", "2026-06-21 12:00:00Z", "20x6-06-21T12:00Z"})
        EXPECT_FALSE(parse_time(text)) << text;
}

}  // namespace
}  // namespace lucarne::gi
