#include "gi/scene/photometry.h"

#include <cmath>

#include <gtest/gtest.h>

namespace lucarne::gi {
namespace {

TEST(Photometry, APointOfOneWattPerSteradianSendsFourPiTimesTheEfficacyOfWhite) {
    SceneLight point;
    point.kind = LightKind::point;
    EXPECT_NEAR(luminous_flux(point, 1), 4 * M_PI * 179, 1e-9);
}

TEST(Photometry, ASpotSendsWhatItsFallOffIntegratesTo) {
    SceneLight spot;
    spot.angle = 1.2, spot.softness = 0.4;
    const double outer = std::cos(0.6), inner = std::cos(0.6 * 0.6);
    double sum = 0;
    constexpr int kSteps = 100000;
    for (int i = 0; i < kSteps; ++i) {
        const double cosine = outer + (1 - outer) * (i + .5) / kSteps;
        const double t = std::clamp((cosine - outer) / (inner - outer), 0.0, 1.0);
        sum += t * t * (3 - 2 * t) * (1 - outer) / kSteps;
    }
    EXPECT_NEAR(luminous_flux(spot, 1), 179 * 2 * M_PI * sum, 1e-3);
}

TEST(Photometry, AreasCountInMetresWhateverTheScansUnit) {
    SceneLight panel;
    panel.kind = LightKind::rectangle;
    panel.width = 10, panel.height = 20;
    EXPECT_NEAR(luminous_flux(panel, .1), 179 * M_PI * 2, 1e-9);
}

TEST(Photometry, LumensThatAreSetAreRead) {
    for (const LightKind kind :
         {LightKind::spot, LightKind::point, LightKind::directional, LightKind::disc}) {
        SceneLight light;
        light.kind = kind;
        light.strength = {1, .5, .1};
        set_luminous_flux(light, 800, .3);
        EXPECT_NEAR(luminous_flux(light, .3), 800, 1e-9);
        EXPECT_NEAR(light.strength.y / light.strength.x, .5, 1e-12);
        light.strength = glm::dvec3(0);
        set_luminous_flux(light, 800, .3);
        EXPECT_NEAR(luminous_flux(light, .3), 800, 1e-9);
    }
}

TEST(Photometry, TheTemperatureOfABlackBodyIsFound) {
    for (const double kelvin : {2000.0, 2700.0, 4000.0, 6504.0, 11000.0})
        EXPECT_NEAR(black_body_temperature(3.0 * black_body_colour(kelvin)), kelvin, kelvin * 1e-6);
    EXPECT_NEAR(black_body_temperature({1, 0, 0}), kCoolest, 1) << "no blue: any of the coolest";
    EXPECT_NEAR(black_body_temperature({0, 0, 1}), kHottest, 1);
}

TEST(Photometry, ABlackBodyIsReddishWhenCoolAndBluishWhenHot) {
    const auto candle = black_body_colour(1900), day = black_body_colour(6504),
               sky = black_body_colour(20000);
    EXPECT_EQ(candle.x, 1);
    EXPECT_LT(candle.z, .1);
    EXPECT_NEAR(day.y, 1, .06);  // the locus passes daylight's white on the magenta side
    EXPECT_NEAR(day.z, 1, .07);
    // CIE illuminant A, 2856 K: XYZ 1.09850, 1, 0.35585.
    const auto lamp = black_body_colour(2856);
    EXPECT_NEAR(lamp.y, .8261 / 1.8451, .01);
    EXPECT_NEAR(lamp.z, .2333 / 1.8451, .01);
    EXPECT_EQ(sky.z, 1);
    EXPECT_LT(sky.x, .6);
    EXPECT_EQ(black_body_colour(0), black_body_colour(kCoolest));
}

}  // namespace
}  // namespace lucarne::gi
