#include "whirl/deck/units.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "whirl/core/error.hpp"

using namespace whirl;
using deck::to_si;
using std::numbers::pi;

namespace {

std::string refusal(const std::string& text, const std::string& si) {
  try {
    (void)to_si(text, si);
  } catch (const core::InputError& e) {
    return e.what();
  }
  return "accepted";
}

}  // namespace

TEST(Units, ConvertToTheNearestDouble) {
  EXPECT_EQ(to_si("110 um", "m"), 1.1e-4);
  EXPECT_EQ(to_si("180um", "m"), 1.8e-4);
  EXPECT_EQ(to_si("0.4 mm", "m"), 4e-4);
  EXPECT_EQ(to_si("6.7 mPa s", "Pa s"), 6.7e-3);
  EXPECT_EQ(to_si("1.0e9 N/m", "N/m"), 1e9);
  EXPECT_EQ(to_si("2.5 mm/s", "m/s"), 2.5e-3);
  EXPECT_EQ(to_si("212 GPa", "Pa"), 212e9);
  EXPECT_EQ(to_si("50 g mm", "kg m"), 5e-5);
  EXPECT_EQ(to_si("-2 kN", "N"), -2000);
  EXPECT_EQ(to_si("+.5 m", "m"), 0.5);
}

TEST(Units, SpeedsAreAnglesPerTime) {
  EXPECT_NEAR(to_si("3600 rpm", "rad/s"), 120 * pi, 1e-11);
  EXPECT_NEAR(to_si("60 rev/s", "rad/s"), 120 * pi, 1e-11);
  EXPECT_NEAR(to_si("360 deg/s", "rad/s"), 2 * pi, 1e-13);
  EXPECT_NEAR(to_si("3600 RPM", "rad/s"), 120 * pi, 1e-11);
  EXPECT_EQ(to_si("377 rad/s", "rad/s"), 377);
  // UDUNITS alone would take 1 Hz for 1 rad/s and 1/min for 0.0167 rad/s.
  for (const char* frequency : {"60 Hz", "3600 1/min", "60 s-1", "60 1/s"})
    EXPECT_NE(refusal(frequency, "rad/s").find("does not fit: expected a speed"), std::string::npos) << frequency;
  EXPECT_NE(refusal("3600", "rad/s").find("has no unit: expected a speed"), std::string::npos);
}

TEST(Units, FrequenciesAreNotSpeeds) {
  EXPECT_EQ(to_si("50 Hz", "Hz"), 50);
  EXPECT_NEAR(to_si("3000 1/min", "Hz"), 50, 1e-12);
  EXPECT_NE(refusal("3000 rpm", "Hz").find("60 rpm is 1 Hz"), std::string::npos);
  EXPECT_NE(refusal("50 Bq", "Hz").find("becquerel"), std::string::npos);
}

// Of a transfer function: by cycles or by angle.
TEST(Units, FrequenciesInCyclesOrAngles) {
  const std::string_view si = deck::frequency;
  EXPECT_NEAR(to_si("60 Hz", std::string(si)), 120 * pi, 1e-11);
  EXPECT_NEAR(to_si("0.06 kHz", std::string(si)), 120 * pi, 1e-11);
  EXPECT_EQ(to_si("3600 rpm", std::string(si)), to_si("3600 rpm", "rad/s"));
  EXPECT_EQ(to_si("377 rad/s", std::string(si)), 377);
  for (const char* other : {"60 1/s", "3600 1/min", "60 m"})
    EXPECT_NE(refusal(other, std::string(si)).find("a frequency such as 60 Hz, 3600 rpm or 377 rad/s"),
              std::string::npos)
        << other;
  EXPECT_NEAR(deck::from_si(120 * pi, "Hz", si), 60, 1e-13);
  EXPECT_NEAR(deck::from_si(120 * pi, "rpm", si), 3600, 1e-11);
  EXPECT_EQ(deck::write_quantity(to_si("60 Hz", si), "Hz", si), "60 Hz");
  EXPECT_EQ(deck::write_quantity(to_si("0.1 Hz", si), "Hz", si), "0.1 Hz");
  EXPECT_TRUE(deck::same_kind("Hz", si));
  EXPECT_TRUE(deck::same_kind(si, "rpm"));
  EXPECT_FALSE(deck::same_kind("N", si));
}

TEST(Units, NamesThatEngineersWrite) {
  EXPECT_NEAR(to_si("60 deg", "rad"), pi / 3, 1e-15);
  EXPECT_NEAR(to_si("1 rev", "rad"), 2 * pi, 1e-14);
  EXPECT_NEAR(to_si("6.7 cP", "Pa s"), 6.7e-3, 1e-17);
  EXPECT_EQ(to_si("180 µm", "m"), 1.8e-4);  // micro sign
  EXPECT_EQ(to_si("180 μm", "m"), 1.8e-4);  // Greek letter
  EXPECT_EQ(to_si("1 bar", "Pa"), 1e5);
  EXPECT_NEAR(to_si("1 psi", "Pa"), 6894.757293168, 1e-6);
  EXPECT_NEAR(to_si("1 in", "m"), 0.0254, 1e-16);
}

TEST(Units, TemperaturesCarryTheirOffsetAndDifferencesDoNot) {
  EXPECT_EQ(to_si("60 degC", "K"), 333.15);
  EXPECT_NEAR(to_si("32 degF", "K"), 273.15, 1e-10);
  EXPECT_EQ(to_si("300 K", "K"), 300);
  EXPECT_EQ(to_si("20 K", "delta K"), 20);
  EXPECT_NE(refusal("20 degC", "delta K").find("temperature difference"), std::string::npos);
  EXPECT_NE(refusal("60 C", "K").find("coulomb"), std::string::npos);
  EXPECT_NE(refusal("140 F", "K").find("farad"), std::string::npos);
  EXPECT_EQ(to_si("0.14 W/m/K", "W/m/K"), 0.14);
}

TEST(Units, KindOfQuantityIsChecked) {
  EXPECT_NE(refusal("180 kg", "m").find("expected a length"), std::string::npos);
  EXPECT_NE(refusal("60 rad", "1").find("expected a bare number"), std::string::npos);
  EXPECT_NE(refusal("50 %", "1").find("expected a bare number"), std::string::npos);
  EXPECT_NE(refusal("1.05", "rad").find("has no unit"), std::string::npos);
  EXPECT_EQ(to_si("0.5", "1"), 0.5);
  EXPECT_TRUE(deck::same_kind("rpm", "rad/s"));
  EXPECT_FALSE(deck::same_kind("Hz", "rad/s"));
}

TEST(Units, WhatIsNoQuantity) {
  EXPECT_EQ(refusal("", "m"), "there is no number");
  EXPECT_EQ(refusal("um", "m"), "'um' is not a number");
  EXPECT_NE(refusal("0,18 mm", "m").find("decimal point"), std::string::npos);
  EXPECT_NE(refusal("nan m", "m").find("not a finite number"), std::string::npos);
  EXPECT_NE(refusal("1e999 m", "m").find("not a finite number"), std::string::npos);
  EXPECT_NE(refusal("1 2 m", "m").find("second number"), std::string::npos);
  EXPECT_NE(refusal("3 m @ 2", "m").find("not a unit"), std::string::npos);
  EXPECT_NE(refusal("3 s since 2000-01-01", "s").find("not a unit"), std::string::npos);
  EXPECT_NE(refusal("180 uM", "m").find("did you mean 'um'?"), std::string::npos);
  EXPECT_NE(refusal("15 mPas", "Pa s").find("did you mean 'mPa s'?"), std::string::npos) << "not the pressure MPa";
  EXPECT_EQ(refusal("15 mPas", "Pa").find("mPa s"), std::string::npos);
}

TEST(Units, OfMemory) {
  EXPECT_EQ(to_si("8 GB", "byte"), 8e9);
  EXPECT_EQ(to_si("512 MiB", "byte"), 536870912);
  EXPECT_EQ(to_si("5 byte", "byte"), 5);
  EXPECT_NE(refusal("8 kg", "byte").find("expected a size of memory"), std::string::npos);
  EXPECT_EQ(deck::write_memory(1.234e9), "1.23 GB");
}

TEST(Units, ResultsAreFinite) {
  EXPECT_EQ(refusal("1e308 kN", "N"), "'1e308 kN' is not a finite number in SI units");
  EXPECT_EQ(refusal("-1e308 t", "kg"), "'-1e308 t' is not a finite number in SI units");
  EXPECT_EQ(to_si("1e308 mN", "N"), 1e305);
}

TEST(Units, FactorsKeepTheUnit) {
  EXPECT_EQ(deck::scaled("180 um", 1.2), "216 um");
  EXPECT_EQ(deck::scaled("60", 1.1), "66");
  EXPECT_EQ(deck::scaled("200 mm", 0.5), "100 mm");
  EXPECT_THROW((void)deck::scaled("60 degC", 2), core::InputError);
  EXPECT_THROW((void)deck::scaled("1e300 m", 1e300), core::InputError);
}

TEST(Units, WrittenQuantitiesReadBackExactly) {
  for (const char* unit : {"m", "um", "rpm", "rad/s", "K", "degC", "GPa", "mm/s", "deg"})
    for (double v : {1.0 / 3, 273.15, 1e-7, 104.71975511965977, 523.59877559829881, 2.1e11, 6.25, 377.0}) {
      const std::string text = deck::write_quantity(v, unit);
      // A unit with an offset or a factor may skip doubles; then the text is as near as its numbers allow.
      EXPECT_NEAR(deck::number_to_si(deck::split_quantity(text).number, unit), v, 3e-16 * (std::abs(v) + 300)) << text;
    }
  EXPECT_EQ(deck::write_quantity(1.1e-4, "um"), "110 um");
  EXPECT_EQ(deck::write_quantity(to_si("3600 rpm", "rad/s"), "rpm"), "3600 rpm");
  EXPECT_EQ(deck::write_quantity(1e9, "N/m"), "1e9 N/m");
  EXPECT_EQ(deck::write_number(-1.8e9), "-1.8e9");
  EXPECT_EQ(deck::write_number(120000), "120000");
  EXPECT_EQ(deck::write_number(0), "0");
  EXPECT_EQ(deck::write_number(1e-5), "1e-5");
  EXPECT_EQ(deck::write_number(-2.5e-12), "-2.5e-12");
  EXPECT_EQ(deck::write_number(1.5e300), "1.5e300");
  EXPECT_EQ(deck::write_number(1e16), "1e16");
}
