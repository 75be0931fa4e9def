#pragma once
// Where studies put what they found.

namespace whirl::study {

class Results {};

}  // namespace whirl::study
