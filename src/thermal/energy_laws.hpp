#pragma once
// Heat capacity and conductivity over the temperature, as the energy equation has them: relative to those at the
// ambient's temperature, over the rise above that.

#include "whirl/thermal/energy.hpp"

namespace whirl::thermal {

class EnergyLaws {
public:
  explicit EnergyLaws(const EnergyModel& model)
      : model_(model), varied_(!is_constant(model.heat_capacity_law) || !is_constant(model.conductivity_law)) {
    set_ambient(300);
  }
  void set_ambient(double temperature) {
    ambient_ = temperature;
    capacity_there_ = evaluate(model_.heat_capacity_law, temperature).value;
    conductivity_there_ = evaluate(model_.conductivity_law, temperature).value;
  }

  /// Whether any of the two changes with the temperature.
  [[nodiscard]] bool varied() const { return varied_; }
  /// J/(kg K), W/(m K), at the ambient's temperature.
  [[nodiscard]] double heat_capacity() const { return model_.heat_capacity * capacity_there_; }
  [[nodiscard]] double conductivity() const { return model_.conductivity * conductivity_there_; }
  /// K: enthalpy above the ambient's over the heat capacity there; its derivative.
  [[nodiscard]] double content(double rise) const {
    return varied_ ? integral(model_.heat_capacity_law, ambient_, ambient_ + rise) / capacity_there_ : rise;
  }
  [[nodiscard]] double capacity(double rise) const {
    return varied_ ? evaluate(model_.heat_capacity_law, ambient_ + rise).value / capacity_there_ : 1.0;
  }
  /// Conductivity over that at the ambient's temperature, and its derivative, 1/K.
  [[nodiscard]] LawValue conduct(double rise) const {
    if (!varied_) return {1, 0};
    const LawValue f = evaluate(model_.conductivity_law, ambient_ + rise);
    return {f.value / conductivity_there_, f.slope / conductivity_there_};
  }

private:
  EnergyModel model_;
  bool varied_;
  double ambient_ = 300, capacity_there_ = 1, conductivity_there_ = 1;
};

}  // namespace whirl::thermal
