#include "whirl/core/from_options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string>

#include "whirl/core/petsc.hpp"

namespace whirl::core {

void set_from_options(SNES snes, std::initializer_list<const char*> types) {
  // The option is read before PETSc makes a solver of that type.
  const char* prefix = nullptr;
  check(SNESGetOptionsPrefix(snes, &prefix));
  char type[64] = "";
  PetscBool given = PETSC_FALSE;
  check(PetscOptionsGetString(nullptr, prefix, "-snes_type", type, sizeof type, &given));
  if (given &&
      std::none_of(types.begin(), types.end(), [&](const char* one) { return std::string_view(type) == one; })) {
    InputError wrong(fmt::format("option -{}snes_type {} of PETSc: this solver can be {}", prefix ? prefix : "", type,
                                 fmt::join(types, ", ")));
    wrong.mark_agreed();  // all ranks have the same options
    throw wrong;
  }
  check(SNESSetFromOptions(snes));
}

}  // namespace whirl::core
