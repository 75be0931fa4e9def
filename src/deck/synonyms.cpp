#include "synonyms.hpp"

#include <algorithm>

namespace whirl::deck {
namespace {

struct Entry {
  std::string_view key, change;
  std::vector<std::string_view> words;
};

const std::vector<Entry>& entries() {
  static const std::vector<Entry> all{
      // Shaft and discs.
      {"rotor", "", {"shaft"}},
      {"segments", "", {"elements", "shaftelements", "beamelements", "beams", "sections", "shaft"}},
      {"discs", "", {"wheels", "impellers", "masses"}},
      {"mass", "the weight divided by 9.81 m/s^2", {"weight"}},
      {"mass", "", {"m"}},
      {"polar_inertia", "", {"ip", "jp", "izz", "jzz", "ipolar", "polarmoment", "polarmomentofinertia"}},
      {"diametral_inertia",
       "",
       {"id", "jd", "it", "jt", "ixx", "jxx", "idiametral", "diametralmoment", "diametralmomentofinertia",
        "diametricalinertia", "transverseinertia", "transversalinertia", "transversemoment",
        "transversemomentofinertia", "equatorialinertia", "lateralinertia"}},
      {"outer_diameter", "", {"od", "do", "outsidediameter", "diameterouter", "d"}},
      {"diameter", "", {"d", "borediameter", "journaldiameter"}},
      {"inner_diameter", "", {"id", "di", "insidediameter", "diameterinner", "borediameter"}},
      {"outer_diameter", "twice the radius", {"radius", "outerradius", "ro", "r"}},
      {"inner_diameter", "twice the radius", {"innerradius", "ri"}},
      {"radius", "", {"r", "journalradius", "boreradius"}},
      {"length", "", {"l", "span", "width", "b", "axiallength"}},
      {"thickness", "", {"width", "length", "l", "b", "t", "h"}},
      {"node", "the number of a node", {"position", "location", "station", "place", "z", "nodenumber"}},
      {"density", "", {"rho"}},
      {"modulus",
       "",
       {"e", "young", "youngs", "youngmodulus", "youngsmodulus", "elasticmodulus", "emodulus", "elasticity"}},
      {"shear_modulus", "", {"g", "gmodulus"}},
      {"poisson", "", {"nu", "poissonratio", "poissonsratio"}},
      // Bearings and supports.
      {"bearings", "", {"journalbearings", "supports", "journals"}},
      {"clearance", "", {"cr", "c", "radialclearance", "gap"}},
      {"clearance",
       "the radial clearance, half of the diametral one",
       {"cd", "diametralclearance", "diametricalclearance", "diameterclearance"}},
      {"preload", "", {"preloadfactor", "preloadratio"}},
      {"arc", "", {"arcangle", "padangle", "arclength"}},
      {"elevation", "", {"height", "alignment"}},
      {"lubricants", "", {"oils", "oil", "fluids", "fluid", "lubricant"}},
      {"lubricant", "", {"oil", "fluid"}},
      {"viscosity", "", {"mu", "eta", "dynamicviscosity", "absoluteviscosity"}},
      {"viscosity", "the kinematic viscosity times the density", {"nu", "kinematicviscosity"}},
      {"stiffness",
       "",
       {"k", "spring", "springconstant", "springrate", "stiffnesscoefficient", "stiffnesscoefficients"}},
      {"damping", "", {"c", "b", "damper", "dashpot", "dampingcoefficient", "dampingcoefficients", "dampingconstant"}},
      {"pedestal", "", {"foundation", "support", "housing"}},
      {"elements", "", {"seals", "springs", "dampers", "seal"}},
      // Forces and studies.
      {"loads", "", {"forces", "staticloads"}},
      {"unbalance", "", {"imbalance", "unbalances", "imbalances"}},
      {"grade", "", {"quality", "balancequality", "balancegrade", "qualitygrade", "g"}},
      {"amount", "", {"magnitude", "unbalance", "u", "massradius"}},
      {"phase", "", {"angle", "phi"}},
      {"title", "", {"name"}},
      {"studies", "", {"analyses", "analysis", "calculations", "tasks"}},
      {"service_speed",
       "",
       {"operatingspeed", "ratedspeed", "nominalspeed", "runningspeed", "designspeed", "workingspeed", "speed", "omega",
        "rpm"}},
      {"speed", "", {"omega", "rpm", "n", "rotationalspeed", "rotorspeed", "shaftspeed", "runningspeed", "spinspeed"}},
      {"speed", "in rpm: 1 Hz is 60 rpm", {"frequency", "f"}},
      {"range", "", {"speedrange", "frequencyrange", "interval"}},
      {"points", "", {"npoints", "numberofpoints", "npts", "steps", "nsteps", "count"}},
      {"from", "", {"start", "begin", "lower", "low", "min", "minimum"}},
      {"to", "", {"end", "stop", "upper", "high", "max", "maximum"}}};
  return all;
}

}  // namespace

std::vector<Synonym> synonyms(std::string_view word) {
  std::string plain;
  for (const char c : word.substr(0, std::min<std::size_t>(word.size(), 60)))
    if (c != '_' && c != '-' && c != ' ') plain += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  std::vector<Synonym> out;
  for (const Entry& e : entries())
    if (std::ranges::find(e.words, plain) != e.words.end()) out.push_back({e.key, e.change});
  return out;
}

}  // namespace whirl::deck
