#include "whirl/thermal/describe.hpp"

#include <algorithm>

#include <numbers>

namespace whirl::thermal {

using deck::positive;

std::span<const deck::Name<FluidOptions::Type>> names(FluidOptions::Type) {
  static constexpr deck::Name<FluidOptions::Type> table[] = {
      {FluidOptions::Type::gas, "gas", "ideal: density p/(r T)"},
      {FluidOptions::Type::liquid, "liquid", "of a density that does not know the pressure"}};
  return table;
}

std::span<const deck::Name<OrificeRing::Inlet>> names(OrificeRing::Inlet) {
  static constexpr deck::Name<OrificeRing::Inlet> table[] = {
      {OrificeRing::Inlet::supply, "supply", "the gas enters with the temperature of the supply"},
      {OrificeRing::Inlet::bush, "bush", "the gas enters with the temperature of the bush at the orifice"}};
  return table;
}

std::span<const deck::Name<WallOptions::Type>> names(WallOptions::Type) {
  static constexpr deck::Name<WallOptions::Type> table[] = {
      {WallOptions::Type::isothermal, "isothermal", "of given temperature"},
      {WallOptions::Type::adiabatic, "adiabatic", "takes no heat"},
      {WallOptions::Type::solid, "solid",
       "conducts heat: a bush in three dimensions, a turning journal as a body of revolution"}};
  return table;
}

std::span<const deck::Name<Turbulence>> names(Turbulence) {
  static constexpr deck::Name<Turbulence> table[] = {
      {Turbulence::laminar, "laminar", "flow coefficients 12"},
      {Turbulence::constantinescu, "constantinescu", "mixing length; coefficients grow with the local Reynolds number"},
      {Turbulence::ng_pan, "ng_pan", "fit to the law of the wall (Ng and Pan 1965), for Reynolds numbers to 30000"}};
  return table;
}

void describe(deck::Description<ConstantViscosity>& d) {
  d.add("value", &ConstantViscosity::value, "Pa s", positive, "dynamic viscosity").required();
}

void describe(deck::Description<Sutherland>& d) {
  d.add("viscosity", &Sutherland::viscosity, "Pa s", positive, "dynamic viscosity at 'temperature'");
  d.add("temperature", &Sutherland::temperature, "K", positive, "at which the viscosity is given");
  d.add("constant", &Sutherland::constant, "K", positive, "Sutherland's constant of the gas", "Sutherland 1893");
}

void describe(deck::Description<Vogel>& d) {
  d.add("viscosity", &Vogel::viscosity, "Pa s", positive, "dynamic viscosity at 'temperature'").required();
  d.add("temperature", &Vogel::temperature, "K", positive, "at which the viscosity is given");
  d.add("b", &Vogel::b, "K", positive, "mu = mu_0 exp(b/(T - c) - b/(T_0 - c))", "Vogel 1921").required();
  d.add("c", &Vogel::c, "K", deck::non_negative, "temperature at which the law ends").required();
  d.check([](const Vogel& v, const deck::Report& r) {
    if (v.c >= v.temperature) r.fail("c", "the law ends at 'c', which must lie below 'temperature'");
  });
}

void describe(deck::Description<Walther>& d) {
  d.add("kinematic", &Walther::kinematic, "m^2/s", positive, "kinematic viscosities at two temperatures", "ASTM D341")
      .required();
  d.add("temperatures", &Walther::temperature, "K", positive, "at which these are given").required();
  d.add("oil_density", &Walther::density, "kg/m^3", positive, "density that makes them dynamic viscosities").required();
  d.check([](const Walther& w, const deck::Report& r) {
    if (w.temperature[0] == w.temperature[1]) return r.fail("temperatures", "'temperatures' must differ");
    if (std::min(w.kinematic[0], w.kinematic[1]) <= 0.3e-6)
      return r.fail("kinematic", "the law holds above 0.3 mm^2/s: are the units right?");
    if ((w.kinematic[0] - w.kinematic[1]) * (w.temperature[1] - w.temperature[0]) <= 0)
      r.fail("kinematic", "the viscosity of an oil falls with the temperature");
  });
}

void describe(deck::Description<Quadratic>& d) {
  d.add("viscosity", &Quadratic::viscosity, "Pa s", positive, "dynamic viscosity at 'celsius'").required();
  d.add("celsius", &Quadratic::celsius, positive, "temperature T_0 in degrees Celsius at which it is given");
  d.add("coefficients", &Quadratic::coefficients, deck::any,
        "mu/mu_0 = c_0 + c_1 t + c_2 t^2 with t the temperature over T_0, both in degrees Celsius",
        "Ferron, Frene and Boncompain 1983")
      .required();
  d.check([](const Quadratic& q, const deck::Report& r) {
    if (q.coefficients[0] + q.coefficients[1] + q.coefficients[2] <= 0)
      r.fail("coefficients", "the viscosity at 'celsius', the sum of the coefficients, must be positive");
  });
}

void describe(deck::Description<ViscosityOptions>& d) {
  d.kinds("type", &ViscosityOptions::law, "law of the viscosity over the temperature");
}

void describe(deck::Description<ConstantLaw>& /*d*/) {}

void describe(deck::Description<LinearLaw>& d) {
  d.add("temperature", &LinearLaw::temperature, "K", positive, "where the property has the value that is given");
  d.add("slope", &LinearLaw::slope, "1/K", deck::any, "relative change with each kelvin").required();
}

void describe(deck::Description<PolynomialLaw>& d) {
  d.add("temperature", &PolynomialLaw::temperature, "K", positive, "temperature T_0 of the polynomial");
  d.add("coefficients", &PolynomialLaw::coefficients, deck::any,
        "the value that is given times c_0 + c_1 x + ... + c_4 x^4 with x = T/T_0",
        "of air Moran and Shapiro 2000, table A-21")
      .required();
}

void describe(deck::Description<PowerLaw>& d) {
  d.add("temperature", &PowerLaw::temperature, "K", positive, "T_0, where the property has the value that is given");
  d.add("exponent", &PowerLaw::exponent, deck::any, "the value that is given times (T/T_0)^n").required();
}

void describe(deck::Description<PropertyOptions>& d) {
  d.kinds("type", &PropertyOptions::law, "factor of the property over the temperature");
}

Fluid make_fluid(const FluidOptions& o) {
  Fluid out;
  out.viscosity = o.viscosity.law;
  out.gas = o.type == FluidOptions::Type::gas;
  out.gas_constant = o.gas_constant;
  out.density = o.density;
  out.heat_capacity = o.heat_capacity;
  out.conductivity = o.conductivity;
  out.density_law = o.density_law.law;
  out.heat_capacity_law = o.heat_capacity_law.law;
  out.conductivity_law = o.conductivity_law.law;
  return out;
}

void describe(deck::Description<FluidOptions>& d) {
  using F = FluidOptions;
  using enum F::Type;
  d.add("type", &F::type, "what the film is filled with");
  d.add("viscosity", &F::viscosity, "dynamic viscosity over the temperature").required();
  d.add("gas_constant", &F::gas_constant, "J/(kg K)", positive, "r of the gas").only(&F::type, {gas});
  d.add("heat_ratio", &F::heat_ratio, deck::Check{.min = 1, .min_open = true}, "ratio of the specific heats of the gas")
      .only(&F::type, {gas});
  d.add("density", &F::density, "kg/m^3", positive, "density of the liquid").required().only(&F::type, {liquid});
  d.add("heat_capacity", &F::heat_capacity, "J/(kg K)", positive, "specific heat, of a gas at constant pressure")
      .required();
  d.add("conductivity", &F::conductivity, "W/(m K)", positive, "conductivity").required();
  d.add("density_law", &F::density_law, "density of the liquid over the temperature").only(&F::type, {liquid});
  d.add("heat_capacity_law", &F::heat_capacity_law, "specific heat over the temperature");
  d.add("conductivity_law", &F::conductivity_law, "conductivity over the temperature");
}

void describe(deck::Description<OrificeRing>& d) {
  using O = OrificeRing;
  d.add("count", &O::count, deck::in(1, 10000), "orifices, evenly spaced around the bearing");
  d.add("angle", &O::angle, "rad", deck::any, "place of the first one, from +x counter-clockwise");
  d.add("z", &O::z, "m", deck::any, "place along the shaft, from the mid-plane of the bearing");
  d.add("diameter", &O::diameter, "m", positive, "diameter of each").required();
  d.add("pressure", &O::pressure, "Pa", positive, "absolute pressure of the supply").required();
  d.add("inlet", &O::inlet, "temperature with which the gas enters the film");
  d.add("temperature", &O::temperature, "K", positive, "temperature of the supply");
}

void describe(deck::Description<SupplyGroove>& d) {
  using G = SupplyGroove;
  d.add("angle", &G::angle, "rad", deck::any, "middle of the groove, from +x counter-clockwise").required();
  d.add("width", &G::width, "rad", deck::between(0, 2 * std::numbers::pi),
        "angle that it covers; its edges are moved to the nearest nodes")
      .required();
  d.add("length", &G::length, "m", positive, "length about the mid-plane; that of the bearing if not given");
  d.add("pressure", &G::pressure, "Pa", deck::non_negative, "pressure in it, above that of the ambient");
  d.add("temperature", &G::temperature, "K", positive, "temperature of the fresh oil");
  d.add(
      "mixing", &G::mixing,
      "fresh oil and what the journal carries over are mixed in the groove to one temperature; false: what is carried "
      "over passes beside the fresh oil");
}

void describe(deck::Description<WallOptions>& d) {
  using W = WallOptions;
  using enum W::Type;
  d.add("type", &W::type, "what the wall does with heat");
  d.add("temperature", &W::temperature, "K", positive, "temperature of the wall").only(&W::type, {isothermal});
  d.add("conductivity", &W::conductivity, "W/(m K)", positive, "conductivity of the solid")
      .required()
      .only(&W::type, {solid});
  d.add("radius", &W::radius, "m", deck::non_negative,
        "of a bush its outer radius, of a journal that of its bore (0 if it is not hollow)")
      .required()
      .only(&W::type, {solid});
  d.add("layers", &W::layers, deck::in(2, 10000), "cells from the film to the other side").only(&W::type, {solid});
  d.add("convection", &W::convection, "W/(m^2 K)", deck::non_negative, "heat transfer at the free surfaces")
      .only(&W::type, {solid});
  d.add("bore_convection", &W::bore_convection, "W/(m^2 K)", deck::non_negative,
        "the same in the bore of a journal; 'convection' if not given")
      .only(&W::type, {solid});
  d.add("ambient", &W::ambient, "K", positive, "temperature beyond the free surfaces").only(&W::type, {solid});
  d.add("shaft_length", &W::shaft_length, "m", deck::non_negative, "length of a journal, from end to end")
      .only(&W::type, {solid});
  d.add("shaft_before", &W::shaft_before, "m", deck::non_negative, "of this, what lies before the film (at smaller z)")
      .only(&W::type, {solid});
  d.add("growth", &W::growth, "its thermal expansion changes the clearance: each section grows as a ring free of load")
      .only(&W::type, {solid});
  d.add("expansion", &W::expansion, "1/K", deck::non_negative, "linear expansion of the solid, for 'growth'",
        "Timoshenko and Goodier 1951, section 135")
      .only(&W::type, {solid});
  d.add("reference", &W::reference, "K", positive,
        "temperature at which the clearance is that of the bearing, for 'growth'; 'ambient' if not given")
      .only(&W::type, {solid});
}

void describe(deck::Description<Ambient>& d) {
  d.add("pressure", &Ambient::pressure, "Pa", positive, "absolute pressure at the ends of the film");
  d.add("temperature", &Ambient::temperature, "K", positive, "of what is drawn in where the flow comes back");
}

}  // namespace whirl::thermal
